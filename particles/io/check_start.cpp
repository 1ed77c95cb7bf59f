#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "common/geometry/bounds.hpp"
#include "particles/base/thread_pool.hpp"
#include "particles/io/fill.hpp"
#include "particles/io/overlaps.hpp"

namespace tandem::particles {
namespace {

[[noreturn]] void fail(const Fill& fill, const scene::Dem& dem, std::size_t sphere,
                       const std::string& problem, const std::string& hint) {
  const std::size_t group = fill.group[sphere];
  throw Error(ErrorCode::scene, problem,
              "dem.particles[" + std::to_string(group) + "] '" + dem.particles[group].name + "'", hint);
}

std::string sphere_at(const Fill& fill, std::size_t i) {
  char text[128];
  const Vec3d p = fill.position[i];
  std::snprintf(text, sizeof text, "sphere %zu at (%.6g, %.6g, %.6g) m", i, p.x, p.y, p.z);
  return text;
}

std::string percent_of_radius(double overlap, double ratio) {
  char text[80];
  std::snprintf(text, sizeof text, "by %.3g m, %.3g %% of the radius", overlap, 100 * ratio);
  return text;
}

double accepted_overlap(const Fill& fill, std::size_t sphere) {
  return fill.accepted_overlap.empty() ? start_overlap_limit : fill.accepted_overlap[fill.group[sphere]];
}

// The largest overlap beyond the accepted ones found so far; of equal ones, the first.
struct Worst {
  double ratio = 0, overlap = 0;
  std::size_t i = 0, j = 0;
  bool found = false;
};

// Calls look(i, worst) for n spheres; each thread processes its share of them.
template <class Look>
Worst worst_of(std::size_t n, ThreadPool& threads, Look look) {
  std::vector<Worst> found(threads.size());
  threads.run([&](unsigned thread) {
    const std::size_t end = n * (thread + 1) / threads.size();
    for (std::size_t i = n * thread / threads.size(); i < end; ++i) look(i, found[thread]);
  });
  // In the order of the spheres: of equal overlaps the first one stays.
  Worst worst;
  for (const Worst& of_thread : found)
    if (of_thread.ratio > worst.ratio) worst = of_thread;
  return worst;
}

// Of overlaps in a bed under its load; otherwise `remedy`.
std::string remedy_of(const Fill& fill, std::size_t i, std::size_t j, const std::string& remedy) {
  const double accepted = std::min(accepted_overlap(fill, i), accepted_overlap(fill, j));
  return accepted > start_overlap_limit ? "use a stiffer material, or a larger dem.overlap_limit" : remedy;
}

void check_spheres(const Fill& fill, const scene::Dem& dem, ThreadPool& threads) {
  const SphereCells cells(fill, periods_of(dem));
  const Worst worst = worst_of(fill.position.size(), threads, [&](std::size_t i, Worst& found) {
    cells.for_partners(i, [&](std::size_t j, Vec3d shift) {
      const double reach = fill.radius[i] + fill.radius[j];
      const double distance2 = norm2(fill.position[i] + shift - fill.position[j]);
      if (distance2 >= reach * reach) return;
      const double overlap = reach - std::sqrt(distance2),
                   ratio = overlap / std::min(fill.radius[i], fill.radius[j]);
      if (ratio > found.ratio && ratio > std::min(accepted_overlap(fill, i), accepted_overlap(fill, j)))
        found = {ratio, overlap, i, j, true};
    });
  });
  if (!worst.found) return;
  const std::string& other = dem.particles[fill.group[worst.j]].name;
  fail(fill, dem, worst.i,
       sphere_at(fill, worst.i) + " overlaps " + sphere_at(fill, worst.j) + " of '" + other + "' " +
           percent_of_radius(worst.overlap, worst.ratio) + " of the smaller",
       remedy_of(fill, worst.i, worst.j,
                 fill.group[worst.i] == fill.group[worst.j] ? "move the spheres apart in the file"
                                                            : "move the fills of the two groups apart"));
}

void check_walls(const Fill& fill, const Surface& surface, const scene::Scene& scene, ThreadPool& threads) {
  const scene::Dem& dem = scene.dem.value();
  Worst worst;  // i: sphere, j: patch
  for (std::size_t body = 0; body < surface.grids.size(); ++body) {
    const Pose pose = start_pose(surface.boundary_bodies[body], scene);
    const Worst of_body = worst_of(fill.position.size(), threads, [&](std::size_t i, Worst& found) {
      for_wall_overlaps(fill, i, surface, body, pose, [&](const WallContact& contact, Vec3d, double ratio) {
        if (ratio > found.ratio && ratio > accepted_overlap(fill, i))
          found = {ratio, -contact.gap, i, contact.patch, true};
      });
    });
    if (of_body.ratio > worst.ratio) worst = of_body;
  }
  if (!worst.found) return;
  fail(fill, dem, worst.i,
       sphere_at(fill, worst.i) + " overlaps " +
           patch_name(surface, static_cast<std::uint32_t>(worst.j), dem) + " " +
           percent_of_radius(worst.overlap, worst.ratio),
       remedy_of(fill, worst.i, worst.i, "move the fill or the wall so that no sphere starts in it"));
}

// The end points of a facet; none for an unbounded one.
std::vector<Vec3d> ends_of(const Facet& facet) {
  if (facet.kind == FacetKind::triangle) return {facet.a, facet.b, facet.c};
  if (facet.kind != FacetKind::cylinder || !std::isfinite(facet.half_height())) return {};
  return {facet.a - facet.half_height() * facet.normal, facet.a + facet.half_height() * facet.normal};
}

}  // namespace

void check_numbers(const Fill& fill, const scene::Dem& dem) {
  for (std::size_t i = 0; i < fill.position.size(); ++i) {
    const Vec3d p = fill.position[i];
    const double r = fill.radius[i];
    if (!is_finite(p) || !is_finite(fill.velocity[i]) || !(r > 0) || !std::isfinite(r)) {
      fail(fill, dem, i, sphere_at(fill, i) + " has a radius, position or velocity that is no number",
           "check its line");
    }
    for (int a = 0; a < 3; ++a) {
      if (p[a] < dem.domain.min[a] || p[a] > dem.domain.max[a]) {
        fail(fill, dem, i, sphere_at(fill, i) + " is outside the domain", "enlarge dem.domain");
      }
    }
  }
}

void check_speeds(const Fill& fill, const scene::Dem& dem, double limit, const std::string& remedy) {
  for (std::size_t i = 0; i < fill.velocity.size(); ++i) {
    const Vec3d v = fill.velocity[i];
    const double speed = std::hypot(v.x, v.y, v.z);  // hypot, because squares of components may overflow
    if (speed < limit) continue;
    const auto& group = dem.particles[fill.group[i]].fill;
    const auto* file = std::get_if<scene::FileFill>(&group);
    const bool inlet = std::holds_alternative<scene::InletFill>(group);
    char text[200];
    std::snprintf(text, sizeof text, "%s %.6g m/s; a run ends with a sphere of %.6g m/s",
                  inlet ? "its spheres come in with" : (sphere_at(fill, i) + " starts with").c_str(), speed,
                  limit);
    fail(fill, dem, i, text,
         (file != nullptr ? "check its line in '" + file->file + "', or the velocity of the group"
                          : std::string("give the group a smaller velocity")) +
             remedy);
  }
}

void check_spins(const Fill& fill, const scene::Dem& dem, double limit) {
  for (std::size_t i = 0; i < fill.spin.size(); ++i) {
    const Vec3d w = fill.spin[i];
    const double speed = fill.radius[i] * std::hypot(w.x, w.y, w.z);
    if (speed < limit) continue;
    const auto* file = std::get_if<scene::FileFill>(&dem.particles[fill.group[i]].fill);
    char text[200];
    std::snprintf(text, sizeof text,
                  "%s starts with a spin by which its surface moves with %.6g m/s; at most %.6g m/s",
                  sphere_at(fill, i).c_str(), speed, limit);
    fail(fill, dem, i, text,
         file != nullptr ? "check its line in '" + file->file + "', wx,wy,wz [rad/s]"
                         : std::string("give a smaller spin"));
  }
}

void check_start(const Fill& fill, const Surface& surface, const scene::Scene& scene, unsigned threads) {
  const bool inlets = std::ranges::any_of(scene.dem.value().particles, [](const scene::ParticleGroup& g) {
    return std::holds_alternative<scene::InletFill>(g.fill);
  });
  if (fill.position.empty() && inlets) return;
  if (fill.position.empty())
    throw Error(ErrorCode::scene, "the fills hold no sphere", "dem.particles", "add a group");
  check_numbers(fill, scene.dem.value());
  ThreadPool pool(threads);
  check_spheres(fill, scene.dem.value(), pool);
  check_walls(fill, surface, scene, pool);
}

std::vector<std::string> warn_of_walls_at_periodic_faces(const Surface& surface, const scene::Scene& scene,
                                                         double largest_radius) {
  const scene::Dem& dem = *scene.dem;
  std::vector<std::string> warnings;
  for (std::uint32_t body = 0; body < surface.grids.size(); ++body) {
    const Pose pose = start_pose(surface.boundary_bodies[body], scene);
    Bounds bounds;
    for (const Facet& facet : surface.facets)
      if (facet.body == body)
        for (const Vec3d& end : ends_of(facet)) bounds.add(pose.p_WB + pose.q_WB.rotate(end));
    for (int a = 0; a < 3; ++a) {
      if (!dem.periodic[static_cast<std::size_t>(a)]) continue;
      const bool below = std::abs(bounds.low[a] - dem.domain.min[a]) < largest_radius,
                 above = std::abs(bounds.high[a] - dem.domain.max[a]) < largest_radius;
      if (!below && !above) continue;
      warnings.push_back("walls of '" + scene.body_name(surface.boundary_bodies[body]) +
                         "' end within a radius of a periodic face along " + "xyz"[a] +
                         ": they are not repeated, let them reach beyond it by a diameter");
    }
  }
  return warnings;
}

}  // namespace tandem::particles
