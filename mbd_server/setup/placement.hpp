// Positions of the scene's points on the links.
#pragma once

#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/element_columns.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/setup/topology.hpp"

namespace tandem::mbd {

struct Placement {
  const scene::Scene& scene;
  const Topology& topology;
  std::vector<Vector3d> origins;  // of the links in the coordinates of the file, world [m]
  // Model::accounts of the scene's joints, couplers, forces and outputs of contacts; none: it has no columns.
  std::vector<int> of_joint, of_coupler, of_force, of_contact;

  void number_accounts(Model& model);

  LinkIndex link_of(const Model& model, BodyId body) const {
    return body == ground ? 0 : model.bodies.at(body.value).link;
  }
  PointOnBody point(const Model& model, BodyId body, Vec3d p_W) const {
    const LinkIndex link = link_of(model, body);
    return {body == ground ? none : static_cast<int>(body.value), link, to_eigen(p_W) - origins[link]};
  }
};

// Parts of build_model(); they need the links, bodies and joints of the model.
void place_closures(const Placement& placement, Model& model);
void place_forces(const Placement& placement, Model& model);
// `meshes`: as of build_model().
void place_contacts(const Placement& placement, const std::vector<NamedMesh>& meshes, Model& model);
// Diameter of a sphere about the largest shape by which a body touches others [m]; 0: there is none.
double largest_contact_shape(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);
// After the contacts, whose shapes the roads are.
void place_roads(const scene::Scene& scene, Model& model);
void add_stiction(Model& model);
// `inputs`: names of the control inputs.
void place_element(const scene::Motor& motor, int account, const std::vector<std::string>& inputs,
                   Model& model);
void place_element(const Placement& placement, const scene::Cylinder& cylinder, int account,
                   const std::vector<std::string>& inputs, Model& model);

}  // namespace tandem::mbd
