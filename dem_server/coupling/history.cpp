#include "dem_server/coupling/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem_server/laws/particle_names.hpp"
#include "particles/geometry/analytic_facets.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/geometry/periods.hpp"

namespace tandem::dem {
namespace {

struct ContactSummary {
  std::string other;
  double ratio = 0;  // overlap over the smaller radius [-]
};
constexpr std::size_t most_contacts_listed = 4;

std::string text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

// A neighbour list would be faster, but this search takes place once and works without one.
void add_spheres(const Spheres& all, std::size_t own, const Periods& periods,
                 std::vector<ContactSummary>& contacts) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == own) continue;
    const double distance = norm(periods.shortest(all.position[own] - all.position[i]));
    const double overlap = all.radius[own] + all.radius[i] - distance;
    if (overlap > 0)
      contacts.push_back(
          {fmt::format("sphere {}", all.id[i]), overlap / std::min(all.radius[own], all.radius[i])});
  }
}

void add_walls(const Spheres& all, std::size_t own, const Surface& surface, std::span<const BodyPose> poses,
               const scene::Scene& scene, std::vector<ContactSummary>& contacts) {
  for (std::size_t body = 0; body < surface.grids.size(); ++body) {
    const Vec3d centre = poses[body].R.transpose_times(all.position[own] - poses[body].p);
    const NearFacets near =
        near_facets(surface.grids[body], surface.cell_start.data(), surface.cell_facet.data(), centre);
    for (int k = 0; k < near.count; ++k) {
      WallContact contact;
      if (!touch_facet(surface.facets.data(), near[k], centre, all.radius[own], contact)) continue;
      const std::string other = patch_name(surface, contact.patch, *scene.dem);
      const double ratio = -contact.gap / smaller_radius(surface.facets[near[k]], all.radius[own]);
      const auto known = std::find_if(contacts.begin(), contacts.end(),
                                      [&](const ContactSummary& t) { return t.other == other; });
      if (known == contacts.end())
        contacts.push_back({other, ratio});
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
  std::string text_so_far =
      fmt::format("a micro step before it was at {} m with {} m/s and {} rad/s", text(all.position[own]),
                  text(all.velocity[own]), text(all.spin[own]));
  if (!is_finite(all.position[own])) return text_so_far;
  std::vector<ContactSummary> contacts;
  add_spheres(all, own, periods_of(*scene.dem), contacts);
  add_walls(all, own, surface, poses, scene, contacts);
  if (contacts.empty()) return text_so_far + " and touched nothing";
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const ContactSummary& a, const ContactSummary& b) { return a.ratio > b.ratio; });
  text_so_far += fmt::format(" and had {} contacts: ", contacts.size());
  for (std::size_t k = 0; k < std::min(contacts.size(), most_contacts_listed); ++k)
    text_so_far += fmt::format("{}{} ({:.3g} of the smaller radius)", k > 0 ? ", " : "", contacts[k].other,
                               contacts[k].ratio);
  return text_so_far + (contacts.size() > most_contacts_listed ? ", ..." : "");
}

std::optional<Vec3d> position_in(const protocol::ParticlesFrame& frame, std::uint32_t id) {
  const auto found = std::lower_bound(frame.id.begin(), frame.id.end(), id);
  if (found == frame.id.end() || *found != id) return {};
  const auto at = static_cast<std::size_t>(found - frame.id.begin()) * 3;
  return Vec3d{frame.position[at], frame.position[at + 1], frame.position[at + 2]};
}

}  // namespace tandem::dem
