// Whether what a particle participant says agrees with the scene and with itself: its account of the first
// window with the spheres of the scene, each frame with the scene and with the account, and the change of the
// angular momentum from frame to frame with the torques of the loads.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "launch/coordinator/scene_spheres.hpp"
#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {

// Spheres of a frame that cannot be those of the scene: of the frame with most of them.
struct FalseSpheres {
  std::uint64_t spheres = 0;
  double time = 0;      // [s]
  std::string example;  // "sphere 7 has the radius 0.02 m, and its group 'beads' 0.01 m"
};
// A figure of the frames that differs from that of the account: the largest difference.
struct FrameDifference {
  double share = 0;    // relative to what is compared [-]
  double time = 0;     // [s]
  std::string values;  // "(0, 0, -1), and in the account (0, 0, -2) kg m/s"
};

class ParticleWatch {
 public:
  explicit ParticleWatch(const SceneFile& file);

  const SceneSpheres& spheres() const { return spheres_; }

  // A window that was accepted. Throws Error{protocol} where the account is impossible with this scene.
  void record(const Exchange& exchange);
  // A frame at the end of the last window. Throws Error{protocol} where the spheres of the frame at t = 0 are
  // not where the scene has them, or have another velocity.
  void observe(const protocol::ParticlesFrame& frame);

  // "number", "radius", "place".
  static constexpr std::array kinds{"number", "radius", "place"};
  const std::array<FalseSpheres, 3>& false_spheres() const { return false_spheres_; }
  // "momentum", "kinetic energy", "centre of mass", "impulse of gravity".
  static constexpr std::array figures{"momentum", "kinetic energy", "centre of mass", "impulse of gravity"};
  const std::array<FrameDifference, 4>& differences() const { return differences_; }
  bool compared() const { return compared_; }  // whether there was a frame after a window

  // Angular momentum that no torque gave, relative to the torques [-]; none where no two frames have the same
  // spheres, or nothing loaded a wall.
  std::optional<double> angular_momentum_balance() const;

 private:
  // Sums over the spheres of a frame.
  struct Sums {
    std::uint64_t lost = 0;
    std::size_t spheres = 0;
    double mass = 0, energy = 0;  // [kg] [J]
    double momentum_size = 0;     // sum of m |v| [kg m/s]
    double angular_size = 0;      // sum of m |x| |v| [kg m2/s]
    Vec3d first;                  // sum of m x [kg m]
    Vec3d momentum;               // [kg m/s]
    Vec3d angular;                // angular momentum [kg m2/s]
  };
  // Sums over the windows since a frame. Places are relative to `origin_`.
  struct Interval {
    double time = 0;        // [s]
    Vec3d travelled;        // integral of the momentum [kg m]
    Vec3d travelled_twice;  // integral of that [kg m s]
    Vec3d torque;           // of the bodies and the ground on the particles, integrated [N m s]
    double torques = 0;     // sum of the magnitudes of their torques [N m s]
    double change = 0;      // sum over the windows of length times change of the momentum [kg m]
  };

  void expect_start(const protocol::LoadSet& load) const;
  void expect_start(const protocol::ParticlesFrame& frame) const;
  void expect_possible(const protocol::ParticleAccount& account) const;
  void add_torques(const Exchange& exchange);
  void count_false(const protocol::ParticlesFrame& frame);
  Sums sums_of(const protocol::ParticlesFrame& frame) const;
  void compare_account(const Sums& sums, double time);
  void compare_gravity(const Sums& sums, double time);
  void compare_angular(const Sums& sums, double time);

  const scene::Scene scene_;
  SceneSpheres spheres_;
  double largest_radius_ = 0;  // [m]
  Vec3d origin_;               // centre of the domain [m]
  Vec3d domain_shift_[2];      // at the begin and at the end of the last window [m]
  bool open_;                  // spheres come in or go out
  bool periodic_;
  std::optional<protocol::ParticleAccount> account_;  // of the last window
  double window_ = 0;                                 // its length [s]
  std::uint64_t lost_before_ = 0;                     // until the last window
  std::array<FalseSpheres, 3> false_spheres_;
  std::array<FrameDifference, 4> differences_;
  bool compared_ = false;
  std::optional<Sums> last_;  // of the last frame
  Interval interval_;
  double angular_residual_ = 0, angular_scale_ = 0;  // sums over the frames [N m s]
};

}  // namespace tandem::launch
