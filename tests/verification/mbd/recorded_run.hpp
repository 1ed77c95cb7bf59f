// The motion of a scene through the solver as a participant, and how far two of them are apart.
#pragma once

#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "protocol/participant/solver.hpp"
#include "tests/support/rigid_motion.hpp"

namespace tandem::mbd {

struct RecordedRun {
  std::vector<protocol::BodiesFrame> frames;  // at the start, and at the end of each window
  int degrees_of_freedom = 0;
  std::size_t redundant = 0;  // equations that depend on others
  double energy_scale = 0;    // largest kinetic energy or change of the energy [J]
  std::vector<std::string> warnings;
};

// `windows` windows up to `end` [s], without loads. Throws what the solver throws.
RecordedRun record(const scene::Scene& scene, double end, int windows);

// A run of test::in_units(scene, length, mass), in the units of `scene`.
RecordedRun in_units_of(const scene::Scene& scene, RecordedRun run, double length, double mass);

// Masses and moments of inertia, which no rounding touches, changed by up to this share at random.
scene::Scene heavier(const scene::Scene& scene, double share, std::mt19937_64& random);

// Largest distance of two points of the scene [m]: the same in every frame.
double size_of(const scene::Scene& scene);

// Of two runs, the second one seen from the frame of the first; `body` and `joint` say where those of the
// first are in the second. Relative: lengths to the size of the machine, angles to 1 rad, velocities and
// reactions to the largest of the first run, energies to its energy_scale.
struct Deviation {
  double pose = 0, velocity = 0, energy = 0;
  double on_ground = 0;  // of the force and the torque of the machine on the ground
  double reaction = 0;   // of any one joint
  double most() const;   // of pose, velocity, energy
};
struct Indices {
  std::vector<std::size_t> body, joint;
};
Deviation deviation(const scene::Scene& scene, const RecordedRun& first, const RecordedRun& second,
                    const test::RigidMotion& motion, const Indices& indices, std::size_t frames);
Deviation deviation(const scene::Scene& scene, const RecordedRun& first, const RecordedRun& second,
                    const test::RigidMotion& motion = test::RigidMotion(Quat{}));

}  // namespace tandem::mbd
