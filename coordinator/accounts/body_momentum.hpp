// Momentum that the boundary bodies get, against the impulses that act on them: the load that was sent,
// gravity, and what contacts with other bodies give by the account of the frames. Known without the multibody
// solver for a body that nothing else acts on in its free direction: one without joints, or on one hinge or
// slide of the ground, and without forces. A solver that drops a torque, turns a sign or takes other units is
// seen here, whatever it reports.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

class BodyMomentum {
 public:
  // Sums over the windows of the lengths of momentum that no impulse gave, and of the impulses.
  struct Sums {
    double residual = 0, impulse = 0;                  // [N s]
    double angular_residual = 0, angular_impulse = 0;  // [N m s]

    // Relative to the impulses [-]; 0 where there were none.
    double linear() const;
    double angular() const;
  };

  explicit BodyMomentum(const scene::Scene& scene);
  void record(const Exchange& exchange);
  // The frame at the end of that window, or at the start: bodies that touch others are recorded here.
  void observe(const protocol::BodiesFrame& frame);
  // `bodies`: number of bodies of the scene.
  void save_or_restore(Archive& archive, std::size_t bodies);

  // By body; bodies of other kinds are left out.
  const std::map<std::uint32_t, Sums>& sums() const { return sums_; }

 private:
  struct Watched {
    scene::Body body;
    std::optional<scene::Joint> joint;  // hinge or slide of the ground
    bool touches;                       // other bodies
  };
  // A window of a body that waits for the impulse of its contacts; `index` among the boundary bodies.
  struct Waiting {
    protocol::BodyMotion motion;
    Wrench load;
    double length;  // [s]
    std::size_t index;
  };
  void record(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load, double H);
  void record_free(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load, double H,
                   Sums& sums) const;
  void record_hinge(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load, double H,
                    Sums& sums) const;
  void record_slide(const Watched& watched, const protocol::BodyMotion& motion, const Wrench& load, double H,
                    Sums& sums) const;

  Vec3d gravity_;
  std::map<std::uint32_t, Watched> watched_;
  std::map<std::uint32_t, Sums> sums_;
  std::vector<Waiting> waiting_;
  std::size_t bodies_ = 0;        // boundary bodies
  std::vector<double> contacts_;  // of the last frame
};

}  // namespace tandem::launch
