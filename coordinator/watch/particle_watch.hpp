// Whether what a particle participant says agrees with the scene and with itself: its account of the first
// window with the spheres of the scene, each frame with the scene and with the account, and the change of the
// angular momentum from frame to frame with the torques of the loads.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/scene/scene_spheres.hpp"
#include "coordinator/schemes/schemes.hpp"

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

// Windows are recorded in one thread. Frames may be checked in another one, in order: what the windows say of
// a frame is taken when it is received, and goes with it.
class ParticleWatch {
 public:
  explicit ParticleWatch(const SceneFile& file);

  const SceneSpheres& spheres() const { return spheres_; }

  // The run continues from a checkpoint: so many spheres were lost before.
  void continue_after(std::uint64_t lost) { lost_at_begin_ = lost; }

  // A window that was accepted. Throws Error{protocol} where the account is impossible with this scene.
  void record(const Exchange& exchange);
  // The same, without a refusal.
  void add(const Exchange& exchange);
  // Sums over the windows since a frame. Places are relative to the centre of the domain.
  struct Interval {
    double time = 0;        // [s]
    Vec3d travelled;        // integral of the momentum [kg m]
    Vec3d travelled_twice;  // integral of that [kg m s]
    Vec3d torque;           // of the bodies and the ground on the particles, integrated [N m s]
    double torques = 0;     // sum of the magnitudes of their torques [N m s]
    double change = 0;      // sum over the windows of length times change of the momentum [kg m]
  };
  // What the windows up to a frame say of it.
  struct Before {
    std::optional<protocol::ParticleAccount> account;  // of the last window
    double window = 0;                                 // its length [s]
    std::uint64_t lost_before = 0;                     // until that window
    std::array<Vec3d, 2> domain_shift;                 // at its begin and at its end [m]
    Interval interval;                                 // since the frame before
  };
  // For a frame at the end of the last window; the next interval begins.
  Before take_before();
  // Throws Error{protocol} where the spheres of the frame at t = 0 are not where the scene has them, or have
  // another velocity.
  void expect_start(const protocol::ParticlesFrame& frame);
  // May run in another thread than the rest.
  void check(const protocol::ParticlesFrame& frame, const Before& before);
  // All three.
  void observe(const protocol::ParticlesFrame& frame);

  // "number", "radius", "place".
  static constexpr std::array kinds{"number", "radius", "place"};
  std::array<FalseSpheres, 3> false_spheres() const { return found().false_spheres; }
  // "momentum", "kinetic energy", "centre of mass", "impulse of gravity".
  static constexpr std::array figures{"momentum", "kinetic energy", "centre of mass", "impulse of gravity"};
  std::array<FrameDifference, 4> differences() const { return found().differences; }
  bool compared() const { return found().compared; }  // whether there was a frame after a window

  // Angular momentum that no torque gave, relative to the torques [-]; none where no two frames have the same
  // spheres, or nothing loaded a wall.
  std::optional<double> angular_momentum_balance() const;

 private:
  // Sums over the spheres of a frame.
  struct Sums {
    std::uint64_t lost = 0;
    std::uint64_t spheres = 0;
    double mass = 0, energy = 0;  // [kg] [J]
    double momentum_size = 0;     // sum of m |v| [kg m/s]
    double angular_size = 0;      // sum of m |x| |v| [kg m2/s]
    Vec3d first;                  // sum of m x [kg m]
    Vec3d momentum;               // [kg m/s]
    Vec3d angular;                // angular momentum [kg m2/s]
  };
  // Of all frames so far.
  struct Found {
    std::array<FalseSpheres, 3> false_spheres;
    std::array<FrameDifference, 4> differences;
    bool compared = false;
    double largest_energy = 0;                       // kinetic [J]
    double angular_residual = 0, angular_scale = 0;  // sums over the frames [N m s]
  };

  void expect_start(const protocol::LoadSet& load) const;
  void expect_possible(const protocol::ParticleAccount& account) const;
  void add_torques(const Exchange& exchange);
  // Both in one pass over the spheres.
  Sums count_false_and_sum(const protocol::ParticlesFrame& frame, const Before& before, Found& found) const;
  void compare_account(const Sums& sums, const protocol::ParticleAccount& account, double window, double time,
                       Found& found) const;
  void compare_gravity(const Sums& sums, const Before& before, double time, Found& found) const;
  void compare_angular(const Sums& sums, const Interval& interval, double time, Found& found) const;
  Found found() const;

  const scene::Scene scene_;
  SceneSpheres spheres_;
  double largest_radius_ = 0;  // [m]
  Vec3d origin_;               // centre of the domain [m]
  bool open_;                  // spheres come in or go out
  bool periodic_;
  std::uint64_t lost_at_begin_ = 0;
  Before before_;             // the next frame
  bool framed_ = false;       // there was a frame, so that the interval counts
  std::optional<Sums> last_;  // of the last frame
  // Written by check() only. The mutex is a pointer, so that a watch can be moved.
  Found found_;
  std::unique_ptr<std::mutex> found_mutex_ = std::make_unique<std::mutex>();
};

}  // namespace tandem::launch
