// Whether the energy of the bodies in the frames is that of their poses and velocities: kinetic energy,
// energy in gravity and in linear springs, by the masses and inertias of the scene, and the energy of
// contacts between bodies where frames have it. Not known where anything else stores energy. Energies are
// compared with that of the first frame, because the level of gravity is open.
#pragma once

#include <optional>

#include "common/scene/model.hpp"
#include "coordinator/schemes/archive.hpp"

namespace tandem::launch {

class EnergyWatch {
 public:
  explicit EnergyWatch(const scene::Scene& scene);

  void observe(const protocol::BodiesFrame& frame);
  void save_or_restore(Archive& archive);

  // Largest difference of the changes of energy; none where energies are not known, or there was no frame
  // after the first.
  struct Difference {
    double share = 0;                   // of the energy that moves [-]
    double reported = 0, computed = 0;  // changes since the first frame [J]
    double time = 0;                    // [s]
  };
  const std::optional<Difference>& largest() const { return largest_; }

 private:
  struct Spring {
    BodyId body_a, body_b;
    Vec3d point_a, point_b;  // in the frames of the bodies
    double stiffness, length;
  };
  struct Energy {
    double kinetic = 0, potential = 0;  // [J]
    double stored = 0;                  // in springs, a part of `potential` [J]
  };
  Energy energy_of(const protocol::BodiesFrame& frame) const;

  bool known_ = false, touches_ = false;
  std::vector<scene::Body> bodies_;
  Vec3d gravity_;
  std::vector<Spring> springs_;
  double least_scale_ = 0;  // [J]
  // Of the first frame, and the largest energy that moved.
  struct State {
    double reported = 0, kinetic = 0, potential = 0, scale = 0;  // [J]
    std::uint64_t frames = 0;
  } first_;
  std::optional<Difference> largest_;
};

}  // namespace tandem::launch
