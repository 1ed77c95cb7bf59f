#include "common/scene/model.hpp"

namespace tandem::scene {

const std::string& Scene::body_name(BodyId id) const {
  static const std::string inertial = "ground";
  return id == ground ? inertial : mbd->bodies.at(id.value).name;
}

}  // namespace tandem::scene
