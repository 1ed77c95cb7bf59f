#include "launch/mesh_tools/mesh_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "common/geometry/mass_properties.hpp"

namespace tandem::launch {
namespace mesh_check {

using Triangle = std::array<Vec3d, 3>;

struct Interval {
  double low = 1e300, high = -1e300;
  void add(double x) { low = std::min(low, x), high = std::max(high, x); }
};

// Heights of the corners of a triangle above a plane; within round-off of the plane 0.
std::array<double, 3> heights_above(Vec3d point, Vec3d normal, const Triangle& t, double size) {
  std::array<double, 3> height{};
  for (std::size_t i = 0; i < 3; ++i) {
    height[i] = dot(normal, t[i] - point);
    if (std::abs(height[i]) <= 1e-9 * size) height[i] = 0;
  }
  return height;
}

// Where the triangle meets the plane of its heights, along the line of the two planes.
Interval section(const Triangle& t, const std::array<double, 3>& height, Vec3d point, Vec3d along) {
  Interval interval;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = (i + 1) % 3;
    if (height[i] == 0) interval.add(dot(along, t[i] - point));
    if (height[i] * height[k] < 0)
      interval.add(dot(along, t[i] + (height[i] / (height[i] - height[k])) * (t[k] - t[i]) - point));
  }
  return interval;
}

bool goes_through(const std::array<double, 3>& height) {
  const auto [low, high] = std::ranges::minmax(height);
  return low < 0 && high > 0;
}

// What two triangles without a common corner have in common: a line in the inside of both, an edge of the one
// in the inside of the other, or less.
struct Meeting {
  bool through = false;
  std::optional<std::size_t> edge_of_first, edge_of_second;  // opposite to this corner
};

// By the sections of both with the line of their planes [Moller1997].
Meeting meeting_of(const Triangle& a, const Triangle& b) {
  const Vec3d na = cross(a[1] - a[0], a[2] - a[0]), nb = cross(b[1] - b[0], b[2] - b[0]);
  if (!(norm(na) > 0 && norm(nb) > 0)) return {};
  const double size = std::sqrt(std::max(
      {norm2(a[1] - a[0]), norm2(a[2] - a[0]), norm2(b[1] - b[0]), norm2(b[2] - b[0]), norm2(b[0] - a[0])}));
  const auto of_a = heights_above(b[0], (1 / norm(nb)) * nb, a, size),
             of_b = heights_above(a[0], (1 / norm(na)) * na, b, size);
  const bool a_through = goes_through(of_a), b_through = goes_through(of_b);
  if (!a_through && !b_through) return {};
  const Vec3d line = cross(na, nb);
  if (!(norm(line) > 0)) return {};
  const Vec3d along = (1 / norm(line)) * line;
  const Interval one = section(a, of_a, a[0], along), other = section(b, of_b, a[0], along);
  if (!(std::min(one.high, other.high) - std::max(one.low, other.low) > 1e-9 * size)) return {};
  if (a_through && b_through) return {.through = true, .edge_of_first = {}, .edge_of_second = {}};
  // Not both: the other one has two corners in the plane, or one, whose section is a point.
  const auto& flat = a_through ? of_b : of_a;
  const auto off = static_cast<std::size_t>(
      std::ranges::find_if(flat, [](double height) { return height != 0; }) - flat.begin());
  Meeting meeting;
  (a_through ? meeting.edge_of_second : meeting.edge_of_first) = off;
  return meeting;
}

// Do two triangles of one plane have an area in common? No axis separates them, of the normals of their
// edges. Within 1e-6 of their size, as corners of single precision are.
bool lie_on_each_other(const Triangle& a, const Triangle& b) {
  const Vec3d na = cross(a[1] - a[0], a[2] - a[0]);
  if (!(norm(na) > 0)) return false;
  const Vec3d normal = (1 / norm(na)) * na;
  double size2 = 0;
  for (std::size_t i = 0; i < 3; ++i)
    size2 = std::max({size2, norm2(a[(i + 1) % 3] - a[i]), norm2(b[(i + 1) % 3] - b[i])});
  const double within = 1e-6 * std::sqrt(size2);
  for (const Vec3d& corner : b)
    if (std::abs(dot(normal, corner - a[0])) > within) return false;
  for (const Triangle* of : {&a, &b})
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d across = cross(normal, (*of)[(i + 1) % 3] - (*of)[i]);
      if (!(norm(across) > 0)) return false;
      Interval one, other;
      for (std::size_t k = 0; k < 3; ++k) {
        one.add(dot(across, a[k] - a[0]) / norm(across));
        other.add(dot(across, b[k] - a[0]) / norm(across));
      }
      if (std::min(one.high, other.high) - std::max(one.low, other.low) <= within) return false;
    }
  return true;
}

// Edges that lie in the inside of a triangle: there the surface of the edge goes through where it goes on on
// the other side.
class EdgesInTriangles {
 public:
  // Of the edge opposite to a corner of triangle t. Was the edge seen in `other` with a triangle on the other
  // side?
  bool passes(const TriangleMesh& mesh, std::uint32_t t, std::size_t corner, std::uint32_t other) {
    const auto& own = mesh.triangles[t];
    const auto& [i, j, k] = mesh.triangles[other];
    const Vec3d a = mesh.vertices[i], normal = cross(mesh.vertices[j] - a, mesh.vertices[k] - a);
    const bool above = dot(normal, mesh.vertices[own[corner]] - a) > 0;
    const auto [low, high] = std::minmax(own[(corner + 1) % 3], own[(corner + 2) % 3]);
    bool& seen = seen_[{low, high, other}][above ? 1 : 0];
    const bool is_new = !seen;
    seen = true;
    return is_new && seen_[{low, high, other}][above ? 0 : 1];
  }

 private:
  std::map<std::array<std::uint32_t, 3>, std::array<bool, 2>> seen_;
};

// Candidates by the x axis: triangles in the order of their lowest x, each against those that begin before it
// ends.
void find_intersections(const TriangleMesh& mesh, MeshFaults& faults) {
  struct Span {
    Vec3d low, high;
    std::uint32_t triangle;
  };
  std::vector<Span> spans;
  EdgesInTriangles edges;
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
      if (faults.overlaps < most_intersections && !std::ranges::is_permutation(one, other) &&
          lie_on_each_other(corners(a.triangle), corners(b.triangle))) {
        if (faults.overlaps == 0) faults.overlap_at = corners(a.triangle)[0];
        ++faults.overlaps;
      }
      if (std::ranges::any_of(one,
                              [&](std::uint32_t v) { return std::ranges::find(other, v) != other.end(); }))
        continue;
      const Meeting meeting = meeting_of(corners(a.triangle), corners(b.triangle));
      const bool passes =
          meeting.through ||
          (meeting.edge_of_first && edges.passes(mesh, a.triangle, *meeting.edge_of_first, b.triangle)) ||
          (meeting.edge_of_second && edges.passes(mesh, b.triangle, *meeting.edge_of_second, a.triangle));
      if (!passes) continue;
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
  count("lie on each other", faults.overlaps,
        std::string(faults.overlaps == most_intersections ? " or more" : "") +
            " pairs of triangles, the first at " + at(faults.overlap_at) +
            ": the volume between may count twice");
  if (faults.is_inside_out()) line("inside out", "the triangles wind clockwise as seen from outside");
  if (!faults.why_not_solid.empty()) line("no solid", faults.why_not_solid);
  return text;
}

}  // namespace tandem::launch
