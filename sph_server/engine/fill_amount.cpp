#include "sph_server/engine/fill_amount.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/geometry/closing.hpp"
#include "common/scene/fault.hpp"
#include "sph_server/equations/hydrostatic.hpp"

namespace tandem::sph {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& advice) {
  throw Error(ErrorCode::scene, what, "fill", advice);
}

struct Below {
  double volume = 0;  // negative for a mesh whose normals are inwards [m3]
  double depth = 0;   // mean below the level [m]
};

// Sums of tetrahedra whose fourth corner is on the level, so that the cut itself adds nothing.
Below signed_part_below(const TriangleMesh& region, Vec3d up, double level) {
  if (region.vertices.empty()) return {};
  const Vec3d first = region.vertices.front(), origin = first + (level - dot(first, up)) * up;
  double volume = 0, moment = 0;
  for (const auto& t : region.triangles) {
    Vec3d kept[4];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = region.vertices[t[k]] - origin, b = region.vertices[t[(k + 1) % 3]] - origin;
      const double at_a = dot(a, up), at_b = dot(b, up);
      if (at_a <= 0) kept[count++] = a;
      if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))
        kept[count++] = a + (at_a / (at_a - at_b)) * (b - a);
    }
    for (int k = 2; k < count; ++k) {
      const double one = dot(kept[0], cross(kept[k - 1], kept[k])) / 6;
      volume += one;
      moment -= one * dot(kept[0] + kept[k - 1] + kept[k], up) / 4;
    }
  }
  return {volume, volume != 0 ? moment / volume : 0};
}
Below part_below(const TriangleMesh& region, Vec3d up, double level) {
  const Below below = signed_part_below(region, up, level);
  return {std::fabs(below.volume), below.depth};
}

// Mass below the height of a surface in a liquid at rest, divided by rho0 [m3]: the volume, and the integral
// of de/dz times the volume below z, by the points of Gauss and Legendre.
double mass_below(const TriangleMesh& region, Vec3d up, double low, double surface, const Liquid& liquid) {
  constexpr int points = 6;
  constexpr double at[points]{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                              0.7699026741943047, 0.9041172563704749, 0.9815606342467192},
      weight[points]{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                     0.1600783285433462, 0.1069393259953184, 0.0471753363865118};
  const double depth = surface - low, c2 = liquid.sound_speed * liquid.sound_speed, g = norm(liquid.gravity);
  double mass = part_below(region, up, surface).volume;
  for (int k = 0; k < points; ++k)
    for (const double x : {0.5 * (1 - at[k]), 0.5 * (1 + at[k])}) {
      const double slope = g / c2 * std::pow(1 + 6 * g * x * depth / c2, -5.0 / 6);
      mass += 0.5 * weight[k] * depth * slope * part_below(region, up, surface - x * depth).volume;
    }
  return mass;
}

Vec3d upwards(Vec3d gravity) {
  return -1.0 / norm(gravity) * gravity;
}

// Heights of the lowest and of the highest vertex along `up` [m].
std::pair<double, double> extent_along(const TriangleMesh& region, Vec3d up) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3d& v : region.vertices) {
    low = std::min(low, dot(v, up));
    high = std::max(high, dot(v, up));
  }
  return {low, high};
}

// Where the level is along `up` [m].
double level_of(const TriangleMesh& region, Vec3d up, const FillAmount& amount) {
  const auto [low, high] = extent_along(region, up);
  const double whole = part_below(region, up, high).volume + amount.common;
  if (amount.height) {
    if (!(*amount.height > 0 && *amount.height <= (high - low) * (1 + 1e-9)))
      refuse("a height of " + scene::rounded(*amount.height) + " m in a region that is " +
                 scene::rounded(high - low) + " m high",
             "give a height above 0 and of at most that of the region");
    return low + *amount.height;
  }
  if (!(*amount.volume > 0 && *amount.volume <= whole * (1 + 1e-9)))
    refuse((amount.mass ? "a mass of " + scene::rounded(*amount.mass) + " kg and so a volume of "
                        : "a volume of ") +
               scene::rounded(*amount.volume) + " m3 in a region of " + scene::rounded(whole) + " m3",
           "give a volume above 0 and of at most that of the region");
  double lower = low, upper = high;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (lower + upper);
    (part_below(region, up, middle).volume + amount.common < *amount.volume ? lower : upper) = middle;
  }
  return upper;
}

// The same mesh with its normals outwards.
TriangleMesh outwards(TriangleMesh mesh, Vec3d up, double high) {
  if (signed_part_below(mesh, up, high).volume < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// Refuses a mesh that is open below the level. Corners may be on edges of other triangles.
void expect_closed(const TriangleMesh& region, Vec3d up, double level) {
  const Openings openings =
      openings_of(region, [&](Vec3d x) { return dot(x, up) < level - 1e-9 * (1 + std::fabs(level)); });
  double size = 0;
  for (const Vec3d& v : region.vertices) size = std::max(size, norm(v - region.vertices.front()));
  if (const auto& widest = openings.widest; widest && widest->width > 1e-4 * size)
    refuse("a region that is not closed: it has an opening of some " + scene::rounded(widest->width) +
               " m at " + scene::rounded(widest->at) + " m, below the level",
           "give a mesh that is closed up to the level, and whose corners join");
  if (openings.flipped)
    refuse("a region whose triangles do not all wind the same way, as at " +
               scene::rounded(*openings.flipped) + " m, below the level",
           "let them wind counter-clockwise as seen from outside");
}

}  // namespace

std::int64_t nearest_whole(double x) {
  return static_cast<std::int64_t>(std::floor(x + 0.5 - 1e-6));
}

double volume_below(const TriangleMesh& region, Vec3d up, double level) {
  return part_below(region, up, level).volume;
}

double depth_of(const TriangleMesh& region, Vec3d gravity, const FillAmount& amount) {
  if (!(norm(gravity) > 0))
    refuse("a level without gravity", "give gravity, or place the particles otherwise");
  if (amount.height.has_value() == amount.volume.has_value())
    refuse("neither or both of height and volume", "give one of them");
  const Vec3d up = upwards(gravity);
  const double level = level_of(region, up, amount);
  expect_closed(region, up, level);
  return level - extent_along(region, up).first;
}

FilledPart filled_part(const Liquid& liquid, const TriangleMesh& region, const FillAmount& amount) {
  depth_of(region, liquid.gravity, amount);
  FilledPart part;
  part.up = upwards(liquid.gravity);
  const auto [low, high] = extent_along(region, part.up);
  part.region = outwards(region, part.up, high);
  const double level = level_of(part.region, part.up, amount),
               volume = part_below(part.region, part.up, level).volume + amount.common;
  part.particles = static_cast<std::size_t>(nearest_whole(volume * liquid.density / liquid.mass()));
  if (part.particles == 0)
    refuse(
        "a volume of " + scene::rounded(volume) + " m3 below the level",
        "fill more than the volume of a particle, " + scene::rounded(liquid.mass() / liquid.density) + " m3");
  const auto too_much = [&](double height) {
    return mass_below(part.region, part.up, low, height, liquid) + amount.common - volume;
  };
  // By regula falsi with the step of Illinois [DowellJarratt1971].
  double lower = low, upper = level, at_lower = -volume, at_upper = too_much(level);
  for (int k = 0, side = 0; k < 60 && at_upper > 1e-14 * volume; ++k) {
    const double middle = upper - at_upper / (at_upper - at_lower) * (upper - lower), at = too_much(middle);
    if (at > 0) {
      upper = middle, at_upper = at;
      if (side == 1) at_lower *= 0.5;
      side = 1;
    } else {
      lower = middle, at_lower = at;
      if (side == -1) at_upper *= 0.5;
      side = -1;
      if (at > -1e-14 * volume) upper = middle, at_upper = 0;
    }
  }
  part.surface = upper;
  part.level = level;
  part.low = low;
  return part;
}

}  // namespace tandem::sph
