// Positions of the scene's points on the links.
#pragma once

#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/element_columns.hpp"
#include "mbd_server/forces/tyre_data.hpp"
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
// `meshes`: as of build_model().
void place_contacts(const Placement& placement, const std::vector<NamedMesh>& meshes, Model& model);
void place_forces(const Placement& placement, Model& model);  // after the contacts, which have the roads
// Diameter of a sphere about the largest shape by which a body touches others [m]; 0: there is none.
double largest_contact_shape(const scene::Scene& scene, const std::vector<NamedMesh>& meshes);
// The road of a tyre on shapes of the ground, which place_contacts() has placed. `path`: of the tyre in the
// scene.
void place_road(const scene::Scene& scene, const scene::Tyre& from, const std::string& path,
                const Model& model, TyreOnLink& tyre);
// Adds a state of first order; `what`: its name in messages. Returns its index.
int add_first_order_state(Model& model, double start, double scale, const std::string& what);
void add_stiction(Model& model);
// `inputs`: names of the control inputs.
void place_element(const scene::Motor& motor, int account, const std::vector<std::string>& inputs,
                   Model& model);
void place_element(const Placement& placement, const scene::Cylinder& cylinder, int account,
                   const std::vector<std::string>& inputs, Model& model);

}  // namespace tandem::mbd
