// Whether the loads of the particles are on the bodies whose walls the spheres touch. In a frame, a sphere
// that overlaps a plane or a face of a box and approaches it loads the body of that wall, whatever the
// contact law, unless it may have come there in the last micro steps.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {

// A body without a load in a frame in which spheres press on its walls: the frame with most of them.
struct UnloadedWalls {
  std::uint64_t spheres = 0;
  double time = 0;      // [s]
  std::string example;  // "sphere 3 overlaps wall 'floor' by 1.2e-05 m"
};

class WallLoadWatch {
 public:
  explicit WallLoadWatch(const scene::Scene& scene);

  // A window that was accepted. Throws Error{protocol} where the ground has a load and no wall.
  void record(const Exchange& exchange) const;
  // A frame at the end of the window of `exchange`. May run in another thread than the rest.
  void observe(const protocol::ParticlesFrame& frame, const Exchange& exchange);

  // Whether there are planes or boxes, and no fixed spheres.
  bool judges() const { return !faces_.empty(); }
  // By body; the ground has its index.
  std::map<std::uint32_t, UnloadedWalls> unloaded() const {
    const std::scoped_lock lock(*mutex_);
    return unloaded_;
  }

 private:
  // A plane, or a rectangle with the half-lengths along `u` and `v`, in the frame of the body.
  struct Face {
    std::string wall;
    Vec3d point, normal, u, v;
    double half_u, half_v;
    bool two_sided;
  };
  void add(const scene::Wall& wall);
  static bool is_loaded(std::uint32_t body, const Exchange& exchange);

  bool ground_has_walls_ = false;
  std::map<std::uint32_t, std::vector<Face>> faces_;  // by body
  std::map<std::uint32_t, UnloadedWalls> unloaded_;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();  // of unloaded_
};

}  // namespace tandem::launch
