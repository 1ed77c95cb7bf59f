// What the forces of a machine act on, whatever their types.
#pragma once

#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

struct AttachedTo {
  std::vector<BodyId> bodies;  // also the ground
  std::vector<JointId> joints;
};

// Bodies and joints on which a force acts; of a tyre also the wheel.
inline AttachedTo attached_to(const Mbd& mbd) {
  AttachedTo to;
  const auto add = [&](const auto& f) {
    if constexpr (requires { f.body_a; }) to.bodies.insert(to.bodies.end(), {f.body_a, f.body_b});
    if constexpr (requires { f.body; }) to.bodies.push_back(f.body);
    if constexpr (requires { f.points; })
      for (const auto& at : f.points) to.bodies.push_back(at.body);
    if constexpr (requires { f.road; })
      to.bodies.push_back(mbd.joints[f.joint.value].child);
    else if constexpr (requires { f.joint; })
      to.joints.push_back(f.joint);
    if constexpr (requires { f.drum; }) {
      if (f.drum) to.joints.push_back(*f.drum);
    }
  };
  for (const Force& force : mbd.forces) std::visit(add, force);
  return to;
}

}  // namespace tandem::scene
