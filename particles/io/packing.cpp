#include "particles/io/packing.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "particles/io/sphere_neighbours.hpp"

namespace tandem::particles {
namespace {

constexpr double margin = 0.25;       // of the neighbour lists, relative to the radii [-]
constexpr double gap = 5e-3;          // between spheres that were moved apart, relative to their radii [-]
constexpr double share = 0.3;         // of an overlap that a sphere moves in one sweep [-]
constexpr double continued = 0.85;    // part of the last move that a sphere continues [-]
constexpr int patience = 300;         // sweeps in which the largest overlap must decrease
constexpr double longest_move = 0.2;  // of a sphere in one sweep, relative to its radius [-]

class Packing {
 public:
  Packing(PackedSpheres& spheres, const PackingBounds& bounds, ThreadPool& pool)
      : spheres_(spheres),
        bounds_(bounds),
        pool_(pool),
        move_(spheres.moving),
        listed_(spheres.moving),
        next_(spheres.position),
        due_(spheres.moving, 1),
        due_next_(spheres.moving) {}

  PackingResult run(int most_sweeps) {
    PackingResult result;
    double least = std::numeric_limits<double>::infinity(), least_before = least;
    for (rebuild(); result.sweeps < most_sweeps; ++result.sweeps) {
      // Without progress there is no room.
      if (result.sweeps > 0 && result.sweeps % patience == 0) {
        if (least >= 0.8 * least_before) return result;
        least_before = std::exchange(least, std::numeric_limits<double>::infinity());
      }
      result.worst = sweep();
      least = std::min(least, result.worst);
      std::swap(spheres_.position, next_);
      if (farthest_ > margin) rebuild();
      // The boundary may have moved spheres into others, which the next sweep would see.
      result.is_free = result.worst <= 0 && is_packed(spheres_, bounds_, pool_);
      if (result.is_free) return result;
    }
    return result;
  }

 private:
  // New neighbours may overlap.
  void rebuild() {
    list_.build(spheres_, margin, pool_);
    std::ranges::fill(due_, 1);
    farthest_ = 0;
    std::copy_n(spheres_.position.begin(), spheres_.moving, listed_.begin());
  }

  // Returns the largest overlap before the sweep, relative to the smaller radius. A sphere is due when it or
  // a neighbour moved in the sweep before: all others stay.
  double sweep() {
    std::vector<double> worst(pool_.size()), farthest(pool_.size());
    std::ranges::fill(due_next_, 0);
    for_ranges(pool_, spheres_.moving, [&](unsigned thread, std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (due_[i] == 0) {
          next_[i] = spheres_.position[i];
          continue;
        }
        worst[thread] = std::max(worst[thread], move_sphere(i));
        if (next_[i] == spheres_.position[i]) continue;
        set_due(i);
        list_.for_neighbours(i, [&](std::uint32_t j) {
          if (j < spheres_.moving) set_due(j);
        });
        farthest[thread] = std::max(farthest[thread], norm(next_[i] - listed_[i]) / spheres_.radius[i]);
      }
    });
    std::swap(due_, due_next_);
    farthest_ = std::max(farthest_, *std::max_element(farthest.begin(), farthest.end()));
    return *std::max_element(worst.begin(), worst.end());
  }

  // Several threads may mark one sphere.
  void set_due(std::size_t i) { std::atomic_ref(due_next_[i]).store(1, std::memory_order_relaxed); }

  double move_sphere(std::size_t i) {
    const Vec3d p = spheres_.position[i];
    const double r = spheres_.radius[i], mass = r * r * r;
    double worst = 0;
    Vec3d apart;
    list_.for_neighbours(i, [&](std::uint32_t j) {
      const Vec3d line = p - spheres_.position[j];
      const double rj = spheres_.radius[j], reach = (1 + gap) * (r + rj), square = norm2(line);
      if (square >= reach * reach) return;
      const double distance = std::sqrt(square);
      worst = std::max(worst, (r + rj - distance) / std::min(r, rj));
      const double mass_j = rj * rj * rj, part = j < spheres_.moving ? mass_j / (mass + mass_j) : 1;
      // Centres at one position are separated along x.
      const Vec3d direction = distance > 0 ? (1 / distance) * line : Vec3d{i < j ? -1.0 : 1.0, 0, 0};
      apart += (2 * share * part * (reach - distance)) * direction;
    });
    Vec3d move = continued * move_[i] + apart;
    // A sphere that is free stops.
    if (apart == Vec3d{}) move = {};
    if (dot(move_[i], apart) < 0) move = apart;
    if (const double length = norm(move); length > longest_move * r) move *= longest_move * r / length;
    const Vec3d free = p + move, inside = bounds_.moved_inside(free, r);
    move_[i] = inside == free ? move : inside - p;
    next_[i] = inside;
    return worst;
  }

  PackedSpheres& spheres_;
  const PackingBounds& bounds_;
  ThreadPool& pool_;
  NeighbourList list_;
  std::vector<Vec3d> move_, listed_, next_;
  std::vector<unsigned char> due_, due_next_;
  double farthest_ = 0;  // way since the list was built, relative to the radius [-]
};

}  // namespace

PackingResult pack(PackedSpheres& spheres, const PackingBounds& bounds, int most_sweeps, ThreadPool& pool) {
  return Packing(spheres, bounds, pool).run(most_sweeps);
}

bool is_packed(const PackedSpheres& spheres, const PackingBounds& bounds, ThreadPool& pool) {
  const SphereLevels levels(spheres);
  std::atomic<bool> packed{true};
  for_ranges(pool, spheres.moving, [&](unsigned, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end && packed.load(std::memory_order_relaxed); ++i) {
      const Vec3d p = spheres.position[i];
      const double r = spheres.radius[i];
      bool is_free = !bounds.overlaps(p, r);
      if (is_free)
        levels.for_near(p, r, 0, i, [&](std::uint32_t j) {
          const double reach = r + spheres.radius[j];
          is_free = is_free && norm2(spheres.position[j] - p) >= reach * reach;
        });
      if (!is_free) packed.store(false, std::memory_order_relaxed);
    }
  });
  return packed.load();
}

}  // namespace tandem::particles
