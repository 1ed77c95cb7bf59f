// Builds the solver's model and its first state from a scene.
#pragma once

#include "common/geometry/triangle_mesh.hpp"
#include "common/scene/model.hpp"
#include "mbd_server/model/model.hpp"
#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// `meshes`: triangles of the shapes of contact that have a file, by scene::contact_mesh_name(). Throws
// Error{scene} where no spanning tree satisfies the scene: a loop of driven joints, a motion on a joint of
// several freedoms; and where a shape of contact is not usable.
Model build_model(const scene::Scene& scene, const std::vector<NamedMesh>& meshes = {});

// Configuration and rates as the scene gives them; accelerations are zero until the integrator's start.
State initial_state(const Model& model, const scene::Scene& scene);

}  // namespace tandem::mbd
