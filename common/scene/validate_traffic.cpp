// Where particles come in and go out.
#include <algorithm>
#include <cmath>

#include "common/scene/validate_parts.hpp"

namespace tandem::scene {
namespace {

// Share of a spacing by which the edge of an inlet may differ from a whole number of spacings.
constexpr double inlet_edge_tolerance = 1e-6;

void require_edge(double edge, double spacing, const std::string& origin, const std::string& path) {
  const double count = edge / spacing;
  if (std::round(count) >= 1 &&
      std::abs(count - std::round(count)) <= inlet_edge_tolerance * std::fmax(1, count))
    return;
  const double fewer = std::fmax(1, std::floor(count));
  fail(origin, path,
       "the inlet is " + text(edge) + " m wide, which is " + rounded(count) + " times sph.spacing",
       "particles are cubes of one spacing: give " + rounded(fewer * spacing) + " or " +
           rounded((fewer + 1) * spacing));
}

void validate_liquid_inlet(const LiquidInlet& inlet, const Scene& scene, const std::string& origin,
                           const std::string& path) {
  const Sph& sph = *scene.sph;
  require_unit(inlet.pose.q_WB, origin, path + ".orientation");
  Vec3d half;  // of a box around it, in its own axes
  if (const auto* disc = std::get_if<DiscShape>(&inlet.shape)) {
    if (disc->radius < sph.spacing)
      fail(origin, path + ".shape.radius",
           "the radius of " + text(disc->radius) + " m is less than sph.spacing",
           "give at least " + text(sph.spacing));
    half = {disc->radius, disc->radius, 0};
  } else {
    const auto& rectangle = std::get<RectangleShape>(inlet.shape);
    require_edge(rectangle.x, sph.spacing, origin, element(path + ".shape.size", 0));
    require_edge(rectangle.y, sph.spacing, origin, element(path + ".shape.size", 1));
    half = {0.5 * rectangle.x, 0.5 * rectangle.y, 0};
  }
  // The first layers are within two spacings in front of it.
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d at{corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                   corner & 4 ? 2 * sph.spacing : 0};
    const Vec3d x = inlet.pose.p_WB + inlet.pose.q_WB.rotate(at);
    for (int a = 0; a < 3; ++a)
      if (!(x[a] >= sph.domain.min[a] && x[a] <= sph.domain.max[a]))
        fail(origin, path + ".position",
             "the inlet, with two spacings in front of it, reaches to " + rounded(x) +
                 " m, outside the domain",
             "enlarge sph.domain or move the inlet");
  }
  if (inlet.end && *inlet.end <= inlet.start)
    fail(origin, path + ".end",
         "the inlet ends at " + text(*inlet.end) + " s, and starts at " + text(inlet.start) + " s",
         "give a later end");
  if (const std::optional<double> c = sph.liquids.front().sound_speed; c && inlet.speed() > 0.1 * *c)
    fail(origin, path,
         "the liquid comes in with " + rounded(inlet.speed()) + " m/s, more than a tenth of sound_speed",
         "give a sound_speed of " + rounded(10 * inlet.speed()) + " m/s or more, or a larger inlet");
}

}  // namespace

Overlap overlap(const Box& box, const Outlet& outlet) {
  Overlap of;
  if (const auto* region = std::get_if<Box>(&outlet.region)) {
    for (int a = 0; a < 3; ++a) {
      of.some = of.some && region->min[a] < box.max[a] && region->max[a] > box.min[a];
      of.all = of.all && region->min[a] <= box.min[a] && region->max[a] >= box.max[a];
    }
  } else {
    const auto& beyond = std::get<HalfSpace>(outlet.region);
    Vec3d farthest, nearest;  // corners, along the normal
    for (int a = 0; a < 3; ++a) {
      const bool up = beyond.normal[a] > 0;
      farthest[a] = up ? box.max[a] : box.min[a];
      nearest[a] = up ? box.min[a] : box.max[a];
    }
    of = {dot(nearest - beyond.point, beyond.normal) >= 0, dot(farthest - beyond.point, beyond.normal) > 0};
  }
  return of;
}

void require_region(const Outlet& outlet, const std::string& origin, const std::string& path) {
  if (const auto* box = std::get_if<Box>(&outlet.region))
    require_box(box->min, box->max, origin, path);
  else
    require_unit(std::get<HalfSpace>(outlet.region).normal, origin, path + ".normal");
}

void validate_liquid_traffic(const Scene& scene, const std::string& origin) {
  const Sph& sph = *scene.sph;
  for (std::size_t i = 0; i < sph.inlets.size(); ++i)
    validate_liquid_inlet(sph.inlets[i], scene, origin, element("sph.inlets", i));
  for (std::size_t i = 0; i < sph.outlets.size(); ++i) {
    const std::string path = element("sph.outlets", i) + ".region";
    require_region(sph.outlets[i], origin, path);
    if (!overlap(sph.domain, sph.outlets[i]).some)
      fail(origin, path, "no place of sph.domain is in it, so that no particle goes out",
           "move it into the domain");
  }
  if (sph.liquids.front().fill.empty() && sph.inlets.empty())
    fail(origin, element("sph.liquids", 0) + ".fill",
         "there is no liquid: nothing is filled, and no inlet brings any", "give a fill or an inlet");
}

}  // namespace tandem::scene
