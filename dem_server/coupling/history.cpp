#include "dem_server/coupling/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem_server/geometry/analytic_facets.hpp"
#include "dem_server/geometry/facet_contact.hpp"
#include "dem_server/geometry/periods.hpp"

namespace tandem::dem {
namespace {

struct Touch {
  std::string whom;
  double ratio = 0;  // overlap over the smaller radius [-]
};
constexpr std::size_t most_touches = 4;

std::string text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

// A list of neighbours would be quicker to search, but this happens once and needs to know none.
void add_spheres(const Spheres& all, std::size_t own, const Periods& periods, std::vector<Touch>& touches) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == own) continue;
    const double distance = norm(periods.shortest(all.position[own] - all.position[i]));
    const double overlap = all.radius[own] + all.radius[i] - distance;
    if (overlap > 0)
      touches.push_back(
          {fmt::format("sphere {}", all.id[i]), overlap / std::min(all.radius[own], all.radius[i])});
  }
}

void add_walls(const Spheres& all, std::size_t own, const Surface& surface, std::span<const BodyPose> poses,
               const scene::Scene& scene, std::vector<Touch>& touches) {
  for (std::size_t body = 0; body < surface.grids.size(); ++body) {
    const Vec3d centre = poses[body].R.transpose_times(all.position[own] - poses[body].p);
    const NearFacets near =
        near_facets(surface.grids[body], surface.cell_start.data(), surface.cell_facet.data(), centre);
    for (int k = 0; k < near.count; ++k) {
      WallContact contact;
      if (!touch_facet(surface.facets.data(), near[k], centre, all.radius[own], contact)) continue;
      const std::string whom = patch_name(surface, contact.patch, *scene.dem);
      const double ratio = -contact.gap / smaller_radius(surface.facets[near[k]], all.radius[own]);
      const auto known =
          std::find_if(touches.begin(), touches.end(), [&](const Touch& t) { return t.whom == whom; });
      if (known == touches.end())
        touches.push_back({whom, ratio});
      else
        known->ratio = std::max(known->ratio, ratio);
    }
  }
}

}  // namespace

std::string history(const SphereError& error, const Surface& surface, std::span<const BodyPose> poses,
                    const scene::Scene& scene) {
  const Spheres& all = error.before;
  const auto found = std::find(all.id.begin(), all.id.end(), error.id);
  if (found == all.id.end()) return "of the step before nothing is known";
  const auto own = static_cast<std::size_t>(found - all.id.begin());
  std::string told = fmt::format("a micro step before it was at {} m with {} m/s and {} rad/s",
                                 text(all.position[own]), text(all.velocity[own]), text(all.spin[own]));
  if (!is_finite(all.position[own])) return told;
  std::vector<Touch> touches;
  add_spheres(all, own, periods_of(*scene.dem), touches);
  add_walls(all, own, surface, poses, scene, touches);
  if (touches.empty()) return told + " and touched nothing";
  std::stable_sort(touches.begin(), touches.end(),
                   [](const Touch& a, const Touch& b) { return a.ratio > b.ratio; });
  told += fmt::format(" and had {} contacts: ", touches.size());
  for (std::size_t k = 0; k < std::min(touches.size(), most_touches); ++k)
    told += fmt::format("{}{} ({:.3g} of the smaller radius)", k > 0 ? ", " : "", touches[k].whom,
                        touches[k].ratio);
  return told + (touches.size() > most_touches ? ", ..." : "");
}

std::optional<Vec3d> position_in(const protocol::ParticlesFrame& frame, std::uint32_t id) {
  const auto found = std::lower_bound(frame.id.begin(), frame.id.end(), id);
  if (found == frame.id.end() || *found != id) return {};
  const auto at = static_cast<std::size_t>(found - frame.id.begin()) * 3;
  return Vec3d{frame.position[at], frame.position[at + 1], frame.position[at + 2]};
}

}  // namespace tandem::dem
