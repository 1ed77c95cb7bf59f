// Whether the spheres of the frames move as spheres can: no deeper into each other and into planes than the
// account says, no farther than their kinetic energy takes them, in through inlets and out through outlets.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/watch/particle_watch.hpp"

namespace tandem::launch {

// Windows are recorded in one thread. Frames may be checked in another one, in order, as by ParticleWatch.
class SphereWatch {
 public:
  // `spheres` of the scene; both stay alive as long as the watch.
  SphereWatch(const scene::Scene& scene, const SceneSpheres& spheres);

  // A window that was accepted.
  void record(const Exchange& exchange);
  struct PlaneInWorld {
    Vec3d point, normal;
  };
  // What the windows up to a frame say of it.
  struct Before {
    std::optional<protocol::ParticleAccount> account;  // of the last window
    double window = 0, longest_window = 0;             // of the last one, and so far [s]
    double mass_there = -1;  // that gravity acts on, of the last window [kg]; below 0: not known
    bool mass_rose = false;
    double way = 0;                    // integral of sqrt(2 E) since the last frame [sqrt(kg) m]
    std::vector<PlaneInWorld> planes;  // at the end of the last window
  };
  // The first frame, before any window.
  void begin(const protocol::ParticlesFrame& frame);
  // For a frame at the end of the last window.
  Before take_before();
  // Of a large frame a part is searched for overlaps and compared with planes, another part each time. May
  // run in another thread than the rest.
  void check(const protocol::ParticlesFrame& frame, const Before& before);
  // Both.
  void observe(const protocol::ParticlesFrame& frame) {
    begin(frame);
    check(frame, take_before());
  }

  enum class Kind : std::size_t { overlap, plane, path, changed_radius, inlet, outlet };
  struct KindOfFault {
    const char* name;
    const char* check;  // of `tandem conform`, that names the fault
  };
  static constexpr std::array kinds{
      KindOfFault{"overlap", "sphere_impact"}, KindOfFault{"plane", "load_on_ground"},
      KindOfFault{"path", "free_flight"},      KindOfFault{"changed radius", "observe_particles"},
      KindOfFault{"inlet", "inlets"},          KindOfFault{"outlet", "outlet"}};
  std::array<FalseSpheres, kinds.size()> false_spheres() const {
    const std::scoped_lock lock(*published_mutex_);
    return published_;
  }

 private:
  using Frame = protocol::ParticlesFrame;
  struct Plane {
    const scene::Wall* wall = nullptr;
    Vec3d point, normal;  // in the body's frame
  };
  struct Entrance {
    std::string name;
    scene::InletFill fill;
    Vec3d velocity;
    std::uint32_t first = 0;    // id of its first sphere
    std::vector<double> due;    // of each sphere, ascending [s]
    std::uint32_t entered = 0;  // spheres up to the last one that a frame has had
    std::size_t due_by(double time) const;
  };
  struct Place {
    std::uint32_t id;
    float x, y, z, radius;  // [m], relative to `origin_`
  };

  template <class Example>
  void take(Kind kind, std::uint64_t spheres, double time, const Example& example);
  double allowed_overlap() const;  // relative to the smaller radius
  void count_overlaps(const Frame& frame);
  void count_in_planes(const Frame& frame);
  void compare_paths(const Frame& frame);
  void compare_places(double time, double size);
  void count_inlets(const Frame& frame);
  void count_in_outlets(const Frame& frame);

  const scene::Dem& dem_;
  const SceneSpheres& spheres_;
  const Vec3d gravity_;
  Vec3d origin_;  // centre of the domain [m]
  std::vector<Plane> planes_;
  std::vector<Entrance> entrances_;
  Before before_;                     // the next frame
  std::array<double, 3> energies_{};  // at the ends of the last windows [J]
  bool framed_ = false;

  // Of check() only:
  Before windows_;  // those before the frame
  std::array<FalseSpheres, kinds.size()> false_spheres_;
  std::vector<Place> last_, now_;  // of the last frame and of this one, by ascending id
  bool has_last_ = false;
  std::uint64_t frames_ = 0;

  // What check() has found. The mutex is a pointer, so that a watch can be moved.
  std::array<FalseSpheres, kinds.size()> published_;
  std::unique_ptr<std::mutex> published_mutex_ = std::make_unique<std::mutex>();
};

}  // namespace tandem::launch
