// What a run leaves behind in its folder: bodies.csv, joints.csv, particles.{h5,xdmf}, bodies.{h5,xdmf}.
// The summary, the report and the picture are made from these at the end.
//
// Columns: bodies.csv   time, then for each body "NAME.position.x|y|z", "NAME.orientation.w|x|y|z",
// "NAME.velocity.x..",
//                       "NAME.angular_velocity.x..", "NAME.contact_force.x..", "NAME.contact_torque.x.."
//                       (window means; "ground.contact_force.x.." and "ground.contact_torque.." when there
//                       are particles)
//          joints.csv   time, "NAME.q", "NAME.rate", "NAME.reaction_force.x..", "NAME.reaction_torque.x.."
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/scene/model.hpp"
#include "launch/results/signals.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Results {
 public:
  // `meshes` are those of the walls with a mesh file, by wall name; other shapes are made here.
  Results(const std::filesystem::path& folder, const scene::Scene& scene,
          const std::vector<protocol::NamedMesh>& meshes);
  ~Results();

  // One row per window end; nullptr where that solver is absent.
  void record(Nanoseconds time, const protocol::BodiesFrame* bodies, const protocol::LoadSet* loads);
  // One frame of the ParaView series.
  void write_frame(Nanoseconds time, const protocol::BodiesFrame* bodies,
                   const protocol::ParticlesFrame* particles);

  const Signals& bodies() const;
  const Signals& joints() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tandem::launch
