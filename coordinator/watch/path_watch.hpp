// Whether the poses of a multibody participant follow from its velocities: over the windows, the displacement
// and the rotation of a boundary body are the integrals of its velocities. Particles are moved along a cubic
// path through poses and velocities, which is wrong where they do not fit together.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

class PathWatch {
 public:
  // Of a displacement [m] or a rotation vector [rad], since the sums began.
  struct Sums {
    Vec3d open;          // movement that no velocity gave: the movement less the integral
    Vec3d integral;      // of the velocities, by the trapezoid rule
    double allowed = 0;  // error of the integral that a method may have: one window times the changes
                         // of the velocity
    double way = 0;      // the largest distance from where the sums began, by poses or velocities
    // The largest share of `way` that is open beyond what is allowed [-], its length and its time [s].
    double share = 0, largest = 0, time = 0;
  };
  struct Of {
    Sums displacement, rotation;
  };

  explicit PathWatch(const scene::Scene& scene);
  // A window that was accepted.
  void record(const Exchange& exchange);
  // `bodies`: number of bodies of the scene.
  void save_or_restore(Archive& archive, std::size_t bodies);

  const std::map<std::uint32_t, Of>& bodies() const { return bodies_; }

 private:
  std::vector<double> size_;  // by body [m]
  std::map<std::uint32_t, Of> bodies_;
};

}  // namespace tandem::launch
