#include "particles/io/place.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/sizes.hpp"
#include "particles/io/packing.hpp"
#include "particles/io/random.hpp"
#include "particles/io/room.hpp"
#include "particles/io/sphere_neighbours.hpp"

namespace tandem::particles {
namespace {

constexpr double usual_void_fraction = 0.5;
constexpr double jitter = 0.2;  // largest displacement of a site along each axis, relative to the spacing [-]
constexpr int most_packing_sweeps = 3000;
constexpr double most_raise = 4;   // of the top of a bed, relative to the largest radius [-]
constexpr int most_spacings = 24;  // tried for one size of spheres

// Sites of a hexagonal lattice in the room, each displaced at random.
class Sites {
 public:
  Sites(const Room& room, double spacing, std::uint64_t seed) : room_(room), spacing_(spacing), seed_(seed) {
    layer_ = spacing * std::sqrt(2.0 / 3);
    row_ = spacing * std::numbers::sqrt3 / 2;
    layers_ = static_cast<std::size_t>((room.high().z - room.low().z) / layer_) + 1;
  }

  // Those that `accept`, in their order.
  template <class Accept>
  std::vector<Vec3d> accepted(ThreadPool& pool, const Accept& accept) const {
    std::vector<std::vector<Vec3d>> parts(pool.size());
    for_ranges(pool, layers_, [&](unsigned thread, std::size_t first, std::size_t end) {
      for (std::size_t k = first; k < end; ++k) add_layer(k, accept, parts[thread]);
    });
    std::vector<Vec3d> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  template <class Accept>
  void add_layer(std::size_t k, const Accept& accept, std::vector<Vec3d>& sites) const {
    Random random(seed_ + 0x632be59bd9b4e019u * k);
    const Vec3d low = room_.low(), high = room_.high();
    const double z = low.z + (static_cast<double>(k) + 0.5) * layer_;
    const bool odd_layer = k % 2 == 1;
    bool odd_row = false;
    for (double y = low.y + (odd_layer ? row_ / 3 : 0.0); y <= high.y; y += row_, odd_row = !odd_row)
      for (double x = low.x + (odd_layer == odd_row ? 0.0 : spacing_ / 2); x <= high.x; x += spacing_) {
        const double most = jitter * spacing_;
        const double dx = random.uniform(-most, most), dy = random.uniform(-most, most),
                     dz = random.uniform(-most, most);
        const Vec3d site{x + dx, y + dy, z + dz};
        if (accept(site)) sites.push_back(site);
      }
  }

  const Room& room_;
  double spacing_, layer_, row_;  // [m]
  std::uint64_t seed_;
  std::size_t layers_;
};

// Leaves `count` of the sites, chosen at random, in their order.
void thin_out(std::vector<Vec3d>& sites, std::size_t count, Random& random) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (random.uniform(0, 1) * static_cast<double>(sites.size() - i) < static_cast<double>(count - kept))
      sites[kept++] = sites[i];
  sites.resize(kept);
}

void shuffle(std::vector<double>& radii, Random& random) {
  for (std::size_t i = radii.size(); i > 1; --i) std::swap(radii[i - 1], radii[random.bits() % i]);
}

class Placing {
 public:
  Placing(const scene::Scene& scene, std::size_t group, const std::vector<NamedMesh>& meshes,
          const std::vector<FixedSphere>& fixed, const Fill& others, unsigned threads)
      : group_(scene.dem->particles[group]),
        fill_(std::get<scene::PackingFill>(group_.fill)),
        density_(scene.dem->materials[group_.material.value].density),
        surface_(make_surface(scene, meshes, group_.radius_max, fixed)),
        pool_(threads),
        room_(scene, group, surface_, meshes, pool_),
        others_(others) {}

  Placement run() {
    choose_radii();
    const double top = room_.high().z;
    if (chosen_) room_.limit(room_.height_of(needed_));
    const PackingBounds bounds{[this](Vec3d p, double radius) { return room_.moved_inside(p, radius); },
                               [this](Vec3d p, double radius) { return room_.overlaps(p, radius); }};
    const double highest = std::min(top, room_.high().z + most_raise * group_.radius_max);
    std::optional<PackedSpheres> start;
    PackingResult packed;
    while (true) {
      start = starting_points();
      if (start) packed = pack(*start, bounds, most_packing_sweeps, pool_);
      if (packed.is_free) break;
      // A bed of a few layers needs more height than its volume says.
      if (!chosen_ || room_.high().z >= highest) refuse_crowd();
      room_.limit(std::min(highest, room_.high().z + 0.5 * group_.radius_max));
    }
    Placement result;
    result.sweeps = packed.sweeps;
    result.volume = room_.volume();
    for (std::size_t i = 0; i < start->moving; ++i)
      result.position.push_back(room_.frame().world(start->position[i]));
    start->radius.resize(start->moving);
    result.radius = std::move(start->radius);
    const double solid = scene::volume_of(result.radius);
    result.mass = density_ * solid;
    result.void_fraction = 1 - solid / result.volume;
    return result;
  }

 private:
  double void_fraction() const { return fill_.void_fraction.value_or(usual_void_fraction); }

  // Sets the radii, in descending order of size octaves, and the volume that they need.
  void choose_radii() {
    chosen_ = fill_.mass || fill_.count;
    if (fill_.count)
      radii_ = scene::radii_of_count(group_, *fill_.count);
    else
      radii_ = scene::radii_of_volume(
          group_, fill_.mass ? *fill_.mass / density_ : (1 - void_fraction()) * room_.volume());
    if (radii_.empty())
      throw Error(
          ErrorCode::scene,
          fill_.mass ? "the mass of " + scene::text(*fill_.mass) + " kg is less than half a sphere"
                     : "the region holds no sphere at a void fraction of " + scene::text(void_fraction()),
          room_.where(), fill_.mass ? "give a larger mass" : "enlarge the region, or give smaller spheres");
    if (radii_.size() > 2147483647)
      throw Error(ErrorCode::scene, "more than 2147483647 spheres", room_.where(),
                  "give a smaller region, mass or count");
    const double solid = scene::volume_of(radii_);
    needed_ = solid / (1 - void_fraction());
    if (needed_ > (1 + 1e-6) * room_.volume() && chosen_)
      throw Error(ErrorCode::scene,
                  "spheres of " + scene::rounded(density_ * solid) +
                      " kg do not fit: at a void fraction of " + scene::text(void_fraction()) +
                      " the region of " + scene::rounded(room_.volume()) + " m3 holds " +
                      scene::rounded(density_ * (1 - void_fraction()) * room_.volume()) + " kg",
                  room_.where(), "enlarge the region, or give less mass or a smaller void_fraction");
    std::ranges::sort(radii_, std::greater<>());
  }

  // Non-overlapping or slightly overlapping positions; nothing where there is no room for all.
  std::optional<PackedSpheres> starting_points() {
    PackedSpheres spheres;
    Random random(fill_.seed);
    for (std::size_t first = 0; first < radii_.size();) {
      // Sizes within a factor of two are placed together.
      std::size_t end = first;
      while (end < radii_.size() && 2 * radii_[end] > radii_[first]) ++end;
      std::vector<double> sizes(radii_.begin() + static_cast<std::ptrdiff_t>(first),
                                radii_.begin() + static_cast<std::ptrdiff_t>(end));
      const double smallest = sizes.back();
      std::optional<std::vector<Vec3d>> sites = sites_beside(spheres, smallest, sizes.size(), random);
      if (!sites) return {};
      shuffle(sizes, random);
      spheres.position.insert(spheres.position.end(), sites->begin(), sites->end());
      spheres.radius.insert(spheres.radius.end(), sizes.begin(), sizes.end());
      first = end;
    }
    spheres.moving = spheres.radius.size();
    for (std::size_t i = 0; i < others_.position.size(); ++i) {
      spheres.position.push_back(room_.frame().local(others_.position[i]));
      spheres.radius.push_back(others_.radius[i]);
    }
    return spheres;
  }

  // `count` sites with room for a sphere of `radius` between larger spheres and walls.
  std::optional<std::vector<Vec3d>> sites_beside(const PackedSpheres& larger, double radius,
                                                 std::size_t count, Random& random) {
    PackedSpheres obstacles = larger;
    for (std::size_t i = 0; i < others_.position.size(); ++i) {
      obstacles.position.push_back(room_.frame().local(others_.position[i]));
      obstacles.radius.push_back(others_.radius[i]);
    }
    const SphereLevels levels(obstacles);
    const auto accept = [&](Vec3d p) {
      if (p.z + radius > room_.high().z || !room_.holds(p) || room_.overlaps(p, radius)) return false;
      bool is_free = true;
      levels.for_near(p, radius, 0, obstacles.position.size(), [&](std::uint32_t j) {
        const double reach = 0.5 * radius + obstacles.radius[j];
        is_free = is_free && norm2(obstacles.position[j] - p) >= reach * reach;
      });
      return is_free;
    };
    const double wanted = static_cast<double>(count);
    double spacing = std::cbrt(std::numbers::sqrt2 * room_.volume() / wanted);
    const std::uint64_t seed = random.bits();
    for (int tries = 0; tries < most_spacings; ++tries) {
      if (spacing < 0.8 * radius) return {};
      std::vector<Vec3d> sites = Sites(room_, spacing, seed).accepted(pool_, accept);
      if (sites.size() >= count) {
        thin_out(sites, count, random);
        return sites;
      }
      const double there = std::max(static_cast<double>(sites.size()), 0.2 * wanted);
      spacing *= std::min(0.995, std::cbrt(there / wanted));
    }
    return {};
  }

  [[noreturn]] void refuse_crowd() const {
    const double solid = scene::volume_of(radii_);
    throw Error(ErrorCode::scene,
                std::to_string(radii_.size()) + " spheres of " + scene::rounded(density_ * solid) +
                    " kg do not fit into the region of " + scene::rounded(room_.volume()) +
                    " m3: at its void fraction of " + scene::rounded(1 - solid / room_.volume()) +
                    " they overlap each other or the walls",
                room_.where(),
                "enlarge the region, or give a larger void_fraction or less mass; near walls spheres are "
                "less dense");
  }

  const scene::ParticleGroup& group_;
  const scene::PackingFill& fill_;
  const double density_;  // [kg/m3]
  const Surface surface_;
  ThreadPool pool_;
  Room room_;
  const Fill& others_;
  bool chosen_ = false;  // a mass or a number is given
  std::vector<double> radii_;
  double needed_ = 0;  // volume at the void fraction [m3]
};

}  // namespace

Placement place(const scene::Scene& scene, std::size_t group, const std::vector<NamedMesh>& meshes,
                const std::vector<FixedSphere>& fixed, const Fill& others, unsigned threads) {
  return Placing(scene, group, meshes, fixed, others, threads).run();
}

}  // namespace tandem::particles
