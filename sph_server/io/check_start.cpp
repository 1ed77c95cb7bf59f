#include "sph_server/io/check_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "particles/geometry/touch_facet.hpp"
#include "sph_server/neighbours/walls_view.hpp"

namespace tandem::sph {
namespace {

// Visits the sites of a lattice within `margin` of the box around a facet, with their numbers along the axes.
template <class Visit>
void visit_near(const Lattice& l, const particles::Facet& f, double margin, Visit visit) {
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    const double low = std::min({f.a[a], f.b[a], f.c[a]}) - margin,
                 high = std::max({f.a[a], f.b[a], f.c[a]}) + margin;
    const double begin = std::ceil((low - l.box.min[a]) / l.step[a] - 0.5),
                 end = std::floor((high - l.box.min[a]) / l.step[a] - 0.5);
    from[a] = static_cast<int>(std::clamp(begin, 0.0, static_cast<double>(l.count[a])));
    to[a] = static_cast<int>(std::clamp(end, -1.0, static_cast<double>(l.count[a] - 1)));
  }
  int n[3];
  for (n[2] = from[2]; n[2] <= to[2]; ++n[2])
    for (n[1] = from[1]; n[1] <= to[1]; ++n[1])
      for (n[0] = from[0]; n[0] <= to[0]; ++n[0]) visit(l.site(n), n);
}

// Calls each(facet in the world, name of its wall).
template <class Each>
void each_facet(const std::vector<BodyWalls>& walls, std::span<const particles::BodyPose> poses, Each each) {
  for (std::size_t b = 0; b < walls.size(); ++b) {
    const auto in_world = [&](std::uint32_t vertex) {
      return poses[b].p + poses[b].R * walls[b].mesh.vertices[vertex];
    };
    for (std::size_t k = 0; k < walls[b].mesh.triangles.size(); ++k) {
      const auto& t = walls[b].mesh.triangles[k];
      each(particles::triangle_facet(in_world(t[0]), in_world(t[1]), in_world(t[2])), walls[b].wall[k]);
    }
  }
}

// Refuses boxes through which one of the surfaces passes, and particles nearer than nearest_wall to one.
// what: "wall" or "inlet".
void expect_clear(const char* what, const std::vector<BodyWalls>& surfaces,
                  std::span<const particles::BodyPose> poses, const std::vector<Lattice>& lattices,
                  const Sites& sites, double spacing) {
  each_facet(surfaces, poses, [&](const particles::Facet& facet, const std::string& name) {
    for (const Lattice& lattice : lattices)
      visit_near(lattice, facet, spacing, [&](std::size_t site, const int* number) {
        for (int a = 0; a < 3; ++a) {
          if (number[a] + 1 == lattice.count[a]) continue;
          const Vec3d here = sites.position[site];
          Vec3d next = here;
          next[a] += lattice.step[a];
          if (crosses(facet, here, next, edge_margin * spacing))
            throw Error(ErrorCode::scene,
                        fmt::format("{} '{}' passes through the box, between {} m and {} m", what, name,
                                    scene::rounded(here), scene::rounded(next)),
                        place_of_fill(lattice.fill),
                        fmt::format("let the box end at the {}; where liquid is meant on both sides, give a "
                                    "box for each side, or fill the 'inside' of the vessel, which leaves "
                                    "closed walls out",
                                    what));
        }
      });
  });
  const double margin = nearest_wall * spacing;
  each_facet(surfaces, poses, [&](const particles::Facet& facet, const std::string& name) {
    for (const Lattice& lattice : lattices)
      visit_near(lattice, facet, margin, [&](std::size_t site, const int*) {
        particles::WallContact contact;
        if (!particles::touch_triangle(facet, sites.position[site], margin, contact)) return;
        throw Error(
            ErrorCode::scene,
            fmt::format("a particle starts at {} m, nearer than {:.3g} m to {} '{}'",
                        scene::rounded(sites.position[site]), margin, what, name),
            place_of_fill(lattice.fill),
            fmt::format("let the box end at the {}: particles are half a spacing away from its faces", what));
      });
  });
}

// Particles of two inlets that come in at one place would stay there together.
void expect_apart(const std::vector<Inlet>& inlets, double spacing) {
  constexpr double nearest = 0.5;  // [spacings]
  const auto places = [](const Inlet& inlet) {
    std::vector<Vec3d> all;
    for (const Vec3d& site : inlet.site)
      all.push_back(inlet.of.pose.p_WB +
                    inlet.of.pose.q_WB.rotate(site + Vec3d{0, 0, 0.5 * inlet.thickness}));
    return all;
  };
  for (std::size_t k = 1; k < inlets.size(); ++k) {
    const std::vector<Vec3d> here = places(inlets[k]);
    for (std::size_t other = 0; other < k; ++other)
      for (const Vec3d& y : places(inlets[other]))
        for (const Vec3d& x : here)
          if (norm(x - y) < nearest * spacing)
            throw Error(
                ErrorCode::scene,
                fmt::format(
                    "a particle of the inlet '{}' comes in at {} m, less than half a spacing from one "
                    "of the inlet '{}'",
                    inlets[k].of.name, scene::rounded(x), inlets[other].of.name),
                fmt::format("sph.inlets[{}]", k), "move one of them by a spacing, or leave it out");
  }
}

// Behind an inlet its piston would push the liquid away, and jump back through it.
void expect_one_side(const std::vector<Inlet>& inlets, const std::vector<BodyWalls>& walls,
                     std::span<const particles::BodyPose> poses, const std::vector<FilledInside>& insides,
                     double spacing, Vec3d up) {
  for (std::size_t k = 0; k < inlets.size(); ++k)
    for (const Vec3d& site : inlets[k].site) {
      const Vec3d x = inlets[k].of.pose.p_WB + inlets[k].of.pose.q_WB.rotate(site),
                  ahead = inlets[k].of.pose.q_WB.rotate({0, 0, 0.5 * inlets[k].thickness});
      const auto is_liquid = [&](Vec3d at) {
        return std::ranges::any_of(insides, [&](const auto& filled) { return is_below(filled, at, up); });
      };
      if (!is_liquid(x + ahead) || !is_liquid(x - ahead)) continue;
      bool separate = false;
      each_facet(walls, poses, [&](const particles::Facet& facet, const std::string&) {
        separate = separate || crosses(facet, x - ahead, x + ahead, edge_margin * spacing);
      });
      if (!separate)
        throw Error(
            ErrorCode::scene,
            fmt::format("the inlet '{}' has liquid on both sides, at {} m", inlets[k].of.name,
                        scene::rounded(x)),
            fmt::format("sph.inlets[{}]", k),
            "put it on a wall of the vessel or of a nozzle, a solid in the liquid, or above the level");
    }
}

}  // namespace

void check_start(const Sites& sites, const scene::Scene& scene, const std::vector<BodyWalls>& walls,
                 const std::vector<Inlet>& inlets, std::span<const particles::BodyPose> poses) {
  const scene::Sph& sph = scene.sph.value();
  const std::vector<Lattice> lattices = lattices_of(sph.liquids.front(), sph.spacing);
  expect_clear("wall", walls, poses.first(walls.size()), lattices, sites, sph.spacing);
  std::vector<BodyWalls> pistons(inlets.size());
  for (std::size_t k = 0; k < inlets.size(); ++k) {
    pistons[k].mesh = inlets[k].piston;
    pistons[k].wall.assign(inlets[k].piston.triangles.size(), inlets[k].of.name);
  }
  expect_clear("inlet", pistons, poses.last(inlets.size()), lattices, sites, sph.spacing);
}

void check_inlets(const std::vector<Inlet>& inlets, const std::vector<BodyWalls>& walls,
                  std::span<const particles::BodyPose> poses, double spacing,
                  const std::vector<FilledInside>& insides, Vec3d up) {
  expect_apart(inlets, spacing);
  expect_one_side(inlets, walls, poses, insides, spacing, up);
  for (std::size_t k = 0; k < inlets.size(); ++k) {
    const Inlet& inlet = inlets[k];
    const Vec3d ahead{0, 0, 0.5 * inlet.thickness};
    const auto in_world = [&](Vec3d x) { return inlet.of.pose.p_WB + inlet.of.pose.q_WB.matrix() * x; };
    const Vec3d middle = in_world(ahead);
    each_facet(walls, poses, [&](const particles::Facet& facet, const std::string& wall) {
      for (const Vec3d& site : inlet.site) {
        const double distance = norm(site), most = distance - nearest_wall * spacing;
        if (!(most > 0)) continue;
        if (crosses(facet, middle, in_world(most / distance * site + ahead), edge_margin * spacing))
          throw Error(ErrorCode::scene,
                      fmt::format("wall '{}' passes through the inlet '{}': it is between the middle of the "
                                  "inlet and the particle that comes in at {} m",
                                  wall, inlet.of.name, scene::rounded(in_world(site))),
                      fmt::format("sph.inlets[{}]", k),
                      "let the shape of the inlet end at the walls of its nozzle or channel");
      }
    });
  }
}

}  // namespace tandem::sph
