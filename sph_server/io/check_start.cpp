#include "sph_server/io/check_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/scene/fault.hpp"
#include "particles/geometry/touch_facet.hpp"

namespace tandem::sph {
namespace {

// Sites of one box, by their place in the lattice.
struct Lattice {
  const scene::Box* box = nullptr;
  std::size_t first = 0;  // index of the first site
  int count[3]{};
  Vec3d step;  // [m]
};

std::vector<Lattice> lattices_of(const scene::Liquid& liquid, double spacing) {
  std::vector<Lattice> all;
  std::size_t first = 0;
  for (const scene::Box& box : liquid.fill) {
    Lattice& l = all.emplace_back();
    l.box = &box;
    l.first = first;
    std::size_t sites = 1;
    for (int a = 0; a < 3; ++a) {
      l.count[a] = static_cast<int>(std::round((box.max[a] - box.min[a]) / spacing));
      l.step[a] = (box.max[a] - box.min[a]) / l.count[a];
      sites *= static_cast<std::size_t>(l.count[a]);
    }
    first += sites;
  }
  return all;
}

// Visits the sites of a lattice within `margin` of the box around a facet.
template <class Visit>
void visit_near(const Lattice& l, const dem::Facet& f, double margin, Visit visit) {
  int from[3], to[3];
  for (int a = 0; a < 3; ++a) {
    const double low = std::min({f.a[a], f.b[a], f.c[a]}) - margin,
                 high = std::max({f.a[a], f.b[a], f.c[a]}) + margin;
    const double begin = std::ceil((low - l.box->min[a]) / l.step[a] - 0.5),
                 end = std::floor((high - l.box->min[a]) / l.step[a] - 0.5);
    from[a] = static_cast<int>(std::clamp(begin, 0.0, static_cast<double>(l.count[a])));
    to[a] = static_cast<int>(std::clamp(end, -1.0, static_cast<double>(l.count[a] - 1)));
  }
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int i = from[0]; i <= to[0]; ++i)
        visit(l.first +
              (static_cast<std::size_t>(k) * static_cast<std::size_t>(l.count[1]) +
               static_cast<std::size_t>(j)) *
                  static_cast<std::size_t>(l.count[0]) +
              static_cast<std::size_t>(i));
}

}  // namespace

void check_start(const Sites& sites, const scene::Scene& scene, const std::vector<BodyWalls>& walls,
                 std::span<const dem::BodyPose> poses) {
  const scene::Sph& sph = scene.sph.value();
  const double margin = nearest_wall * sph.spacing;
  const std::vector<Lattice> lattices = lattices_of(sph.liquids.front(), sph.spacing);
  for (std::size_t b = 0; b < walls.size(); ++b) {
    const auto in_world = [&](std::uint32_t vertex) {
      return poses[b].p + poses[b].R * walls[b].mesh.vertices[vertex];
    };
    for (const auto& t : walls[b].mesh.triangles) {
      const dem::Facet facet = dem::triangle_facet(in_world(t[0]), in_world(t[1]), in_world(t[2]));
      for (std::size_t k = 0; k < lattices.size(); ++k)
        visit_near(lattices[k], facet, margin, [&](std::size_t site) {
          dem::WallContact contact;
          if (!dem::touch_triangle(facet, sites.position[site], margin, contact)) return;
          throw Error(
              ErrorCode::scene,
              fmt::format("a particle starts at {} m, nearer than {:.3g} m to a wall of '{}'",
                          scene::rounded(sites.position[site]), margin, scene.body_name(walls[b].body)),
              "sph.liquids[0]." + scene::element("fill", k),
              "let the box end at the wall: particles are half a spacing away from its faces");
        });
    }
  }
}

}  // namespace tandem::sph
