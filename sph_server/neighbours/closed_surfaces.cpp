#include "sph_server/neighbours/closed_surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace tandem::sph {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// A number for each place of a corner.
std::vector<Corners> numbered_corners(std::span<const particles::Facet> facets, double tolerance) {
  std::map<std::array<std::int64_t, 3>, std::uint32_t> known;
  std::vector<Corners> all;
  const auto number = [&](Vec3d x) {
    std::array<std::int64_t, 3> place{};
    // The offset keeps coordinates that differ by rounding off the middle between two whole numbers.
    for (int a = 0; a < 3; ++a)
      place[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(std::floor(x[a] / tolerance + 0.3819));
    return known.emplace(place, static_cast<std::uint32_t>(known.size())).first->second;
  };
  for (const particles::Facet& f : facets) all.push_back({number(f.a), number(f.b), number(f.c)});
  return all;
}

struct Edge {
  std::uint32_t low = 0, high = 0, facet = 0;
  bool ascends = false;  // along the edge in the order of the corners of the facet
};
std::vector<Edge> sorted_edges(const std::vector<Corners>& corners) {
  std::vector<Edge> edges;
  for (std::uint32_t f = 0; f < corners.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners[f][k], to = corners[f][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), f, from < to});
    }
  std::ranges::sort(edges, {}, [](const Edge& e) { return std::tuple(e.low, e.high, e.facet, e.ascends); });
  return edges;
}

// Sets of facets that join.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t of(std::uint32_t f) {
    while (parent_[f] != f) f = parent_[f] = parent_[parent_[f]];
    return f;
  }
  void join(std::uint32_t f, std::uint32_t g) {
    f = of(f);
    g = of(g);
    parent_[std::max(f, g)] = std::min(f, g);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Does the segment from p to q pass through the triangle?
bool passes(Vec3d p, Vec3d q, const particles::Facet& f, double tolerance) {
  const double from = dot(p - f.a, f.normal), to = dot(q - f.a, f.normal);
  if (!(std::min(from, to) < -tolerance && std::max(from, to) > tolerance)) return false;
  const Vec3d at = p + (from / (from - to)) * (q - p), corner[3] = {f.a, f.b, f.c};
  for (int k = 0; k < 3; ++k)
    if (dot(cross(corner[k < 2 ? k + 1 : 0] - corner[k], at - corner[k]), f.normal) < 0) return false;
  return true;
}

// Have two facets of one surface points in common, other than at the corners and the edge that they share?
bool intersect(const particles::Facet& f, const particles::Facet& g, const Corners& of_f, const Corners& of_g,
               double tolerance) {
  const auto is_shared = [](std::uint32_t corner, const Corners& of) {
    return std::ranges::count(of, corner) > 0;
  };
  const auto shared = std::ranges::count_if(of_f, [&](std::uint32_t c) { return is_shared(c, of_g); });
  if (shared == 3) return true;
  if (shared == 2) return dot(f.normal, g.normal) < -1 + 1e-12;  // they lie on each other
  const auto edges_pass = [&](const particles::Facet& of, const Corners& own, const particles::Facet& other,
                              const Corners& of_other) {
    const Vec3d corner[3] = {of.a, of.b, of.c};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t end = (k + 1) % 3;
      if (is_shared(own[k], of_other) || is_shared(own[end], of_other)) continue;
      if (passes(corner[k], corner[end], other, tolerance)) return true;
    }
    return false;
  };
  return edges_pass(f, of_f, g, of_g) || edges_pass(g, of_g, f, of_f);
}

struct Bounds {
  Vec3d low, high;  // [m]
  explicit Bounds(const particles::Facet& f) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min({f.a[a], f.b[a], f.c[a]});
      high[a] = std::max({f.a[a], f.b[a], f.c[a]});
    }
  }
};

// Calls each(f, g) for the pairs of facets whose bounds touch.
template <class Each>
void for_touching(std::span<const particles::Facet> facets, Each each) {
  std::vector<Bounds> bounds;
  for (const particles::Facet& f : facets) bounds.emplace_back(f);
  Vec3d low = bounds.front().low, high = bounds.front().high;
  for (const Bounds& b : bounds)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], b.low[a]);
      high[a] = std::max(high[a], b.high[a]);
    }
  int along = 0;
  for (int a = 1; a < 3; ++a)
    if (high[a] - low[a] > high[along] - low[along]) along = a;
  const int other[2] = {(along + 1) % 3, (along + 2) % 3};
  std::vector<std::uint32_t> order(facets.size()), open;  // open: that may reach the next one
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::uint32_t f) { return std::pair(bounds[f].low[along], f); });
  for (const std::uint32_t f : order) {
    const Bounds& own = bounds[f];
    std::erase_if(open, [&](std::uint32_t g) { return bounds[g].high[along] < own.low[along]; });
    for (const std::uint32_t g : open) {
      const Bounds& b = bounds[g];
      if (b.low[other[0]] <= own.high[other[0]] && own.low[other[0]] <= b.high[other[0]] &&
          b.low[other[1]] <= own.high[other[1]] && own.low[other[1]] <= b.high[other[1]])
        each(f, g);
    }
    open.push_back(f);
  }
}

}  // namespace

void add_closed_surfaces(std::span<const particles::Facet> facets, double reach,
                         std::vector<std::uint32_t>& surface) {
  const std::size_t first = surface.size();
  const std::uint32_t highest = surface.empty() ? 0 : *std::ranges::max_element(surface);
  surface.resize(first + facets.size(), 0);
  if (facets.empty()) return;
  const std::vector<Corners> corners = numbered_corners(facets, 1e-7 * reach);
  const std::vector<Edge> edges = sorted_edges(corners);
  Sets sets(facets.size());
  std::vector<bool> open(facets.size(), false);  // of the first facet of a set: it is no closed surface
  for (const bool joined : {false, true})
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
      while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high)
        ++end;
      const bool closes = end - begin == 2 && edges[begin].low != edges[begin].high &&
                          edges[begin].ascends != edges[begin + 1].ascends;
      for (std::size_t k = begin; k < end; ++k) {
        if (!joined) sets.join(edges[begin].facet, edges[k].facet);
        if (joined && !closes) open[sets.of(edges[k].facet)] = true;
      }
    }
  for_touching(facets, [&](std::uint32_t f, std::uint32_t g) {
    const std::uint32_t set = sets.of(f);
    if (set == sets.of(g) && !open[set] &&
        intersect(facets[f], facets[g], corners[f], corners[g], 1e-9 * reach))
      open[set] = true;
  });
  std::map<std::uint32_t, std::uint32_t> number;
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    if (const std::uint32_t set = sets.of(f); !open[set])
      surface[first + f] =
          number.emplace(set, highest + 1 + static_cast<std::uint32_t>(number.size())).first->second;
}

}  // namespace tandem::sph
