#include "launch/mesh_tools/mesh_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

#include "common/geometry/mass_properties.hpp"

namespace tandem::launch {
namespace mesh_check {

using Triangle = std::array<Vec3d, 3>;

// Six times the volume of the tetrahedron a b c d.
double volume6(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  return dot(cross(b - a, c - a), d - a);
}

// Does the segment p q pass through the inside of the triangle?
bool pierces(Vec3d p, Vec3d q, const Triangle& t) {
  const double above = volume6(t[0], t[1], t[2], p), below = volume6(t[0], t[1], t[2], q);
  // Points that are in the plane up to round-off touch it only.
  const double size = norm(cross(t[1] - t[0], t[2] - t[0])), least = 1e-9 * size * norm(q - p);
  if (!(above > least && below < -least) && !(above < -least && below > least)) return false;
  const double u = volume6(p, q, t[0], t[1]), v = volume6(p, q, t[1], t[2]), w = volume6(p, q, t[2], t[0]);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

bool pass_through(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i)
    if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return true;
  return false;
}

// Candidates by the x axis: triangles in the order of their lowest x, each against those that begin before it
// ends.
void find_intersections(const TriangleMesh& mesh, MeshFaults& faults) {
  struct Span {
    Vec3d low, high;
    std::uint32_t triangle;
  };
  std::vector<Span> spans;
  const auto corners = [&](std::uint32_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return Triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
  };
  // The longest axis divides best.
  const Vec3d size = faults.facts.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle p = corners(t);
    Span span{p[0], p[0], t};
    for (int k = 0; k < 3; ++k) {
      span.low[k] = std::min({p[0][k], p[1][k], p[2][k]});
      span.high[k] = std::max({p[0][k], p[1][k], p[2][k]});
    }
    spans.push_back(span);
  }
  std::ranges::sort(spans, [&](const Span& a, const Span& b) {
    return std::pair(a.low[axis], a.triangle) < std::pair(b.low[axis], b.triangle);
  });
  for (std::size_t i = 0; i < spans.size(); ++i)
    for (std::size_t k = i + 1; k < spans.size() && spans[k].low[axis] <= spans[i].high[axis]; ++k) {
      const Span &a = spans[i], &b = spans[k];
      bool apart = false;
      for (int n = 0; n < 3; ++n) apart |= a.low[n] > b.high[n] || b.low[n] > a.high[n];
      if (apart) continue;
      const auto &one = mesh.triangles[a.triangle], &other = mesh.triangles[b.triangle];
      if (std::ranges::any_of(one,
                              [&](std::uint32_t v) { return std::ranges::find(other, v) != other.end(); }))
        continue;
      if (!pass_through(corners(a.triangle), corners(b.triangle))) continue;
      if (faults.intersections == 0) faults.intersection_at = corners(a.triangle)[0];
      if (++faults.intersections == most_intersections) return;
    }
}

void count_shapes(const TriangleMesh& mesh, MeshFaults& faults) {
  std::set<std::array<std::uint32_t, 3>> known;
  for (std::array<std::uint32_t, 3> triangle : mesh.triangles) {
    const auto& [i, j, k] = triangle;
    const Vec3d a = mesh.vertices[i], b = mesh.vertices[j], c = mesh.vertices[k];
    const double longest2 = std::max({norm2(b - a), norm2(c - b), norm2(a - c)}),
                 area2 = norm(cross(b - a, c - a));
    if (area2 < 1e-12 * longest2)
      ++faults.without_area;
    else if (area2 < 1e-3 * longest2)
      ++faults.slivers;
    std::ranges::sort(triangle);
    if (!known.insert(triangle).second) ++faults.duplicates;
  }
}

}  // namespace mesh_check

MeshFaults faults_of(const TriangleMesh& mesh) {
  MeshFaults faults;
  faults.facts = facts_of(mesh);
  mesh_check::count_shapes(mesh, faults);
  mesh_check::find_intersections(mesh, faults);
  if (faults.facts.open_edges == 0 && faults.without_area == 0) faults.why_not_solid = why_not_solid(mesh);
  return faults;
}

std::string report_of(const MeshFaults& faults, const std::string& file) {
  const MeshFacts& facts = faults.facts;
  std::string text = fmt::format("{}: {}\n", file, faults.is_sound() ? "closed and sound" : "has faults");
  const auto line = [&](const std::string& what, const std::string& value) {
    text += fmt::format("  {:<24} {}\n", what, value);
  };
  line("triangles", std::to_string(facts.triangles));
  line("size [m]", fmt::format("{:.6g} x {:.6g} x {:.6g}", facts.size().x, facts.size().y, facts.size().z));
  line("area [m2]", fmt::format("{:.9g}", facts.area));
  line("volume [m3]", facts.volume ? fmt::format("{:.9g}", *facts.volume)
                                   : "none: the surface is not closed, or winds both ways");
  const auto count = [&](const char* what, std::size_t number, const std::string& more = {}) {
    if (number > 0) line(what, std::to_string(number) + more);
  };
  const auto at = [](Vec3d p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z); };
  count("open edges", facts.open_edges,
        facts.openings.empty()
            ? ""
            : fmt::format(", {} openings, the widest {:.3g} m at {}", facts.openings.size(),
                          facts.openings.front().width, at(facts.openings.front().at)));
  count("edges not joined", facts.unjoined_edges,
        fmt::format(", corners up to {:.3g} m apart at {}", facts.widest_gap, at(facts.unjoined_at)));
  count("edges of 3 and more", facts.non_manifold_edges);
  count("edges wound both ways", facts.inverted_edges);
  count("without area", faults.without_area, " triangles");
  count("duplicates", faults.duplicates, " triangles");
  count("slivers", faults.slivers, " triangles, narrower than 1/1000 of their length");
  count("self-intersections", faults.intersections,
        std::string(faults.intersections == most_intersections ? " or more" : "") +
            " pairs of triangles, the first at " + at(faults.intersection_at));
  if (faults.is_inside_out()) line("inside out", "the triangles wind clockwise as seen from outside");
  if (!faults.why_not_solid.empty()) line("no solid", faults.why_not_solid);
  return text;
}

}  // namespace tandem::launch
