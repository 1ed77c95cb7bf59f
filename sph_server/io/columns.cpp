#include "sph_server/io/columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "sph_server/neighbours/walls.hpp"

namespace tandem::sph {
namespace {

bool contains(const scene::Box& box, Vec3d x) {
  for (int a = 0; a < 3; ++a)
    if (x[a] < box.min[a] || x[a] > box.max[a]) return false;
  return true;
}

// Distance from a point in the box to its surface in a direction [m].
double way_out(const scene::Box& box, Vec3d x, Vec3d direction) {
  double way = norm(box.max - box.min);
  for (int a = 0; a < 3; ++a)
    if (direction[a] != 0)
      way = std::min(way, ((direction[a] > 0 ? box.max[a] : box.min[a]) - x[a]) / direction[a]);
  return std::max(way, 0.0);
}

struct Column {
  double length = 0;     // of liquid from a point in a direction, through boxes that touch [m]
  bool at_wall = false;  // where it ends
};
Column column(const std::vector<Lattice>& lattices, const Walls& walls, Vec3d x, Vec3d direction,
              double spacing) {
  Column c;
  std::vector<bool> passed(lattices.size());
  for (;;) {
    const Vec3d end = x + c.length * direction;
    // No wall passes through a box; one within half a spacing beyond leaves no room for the liquid to rise.
    if (c.length > 0 &&
        walls.between(end - std::min(0.5 * spacing, c.length) * direction, end + 0.5 * spacing * direction)) {
      c.at_wall = true;
      return c;
    }
    std::size_t next = 0;
    while (next < lattices.size() &&
           (passed[next] || !contains(lattices[next].box, end + 1e-3 * spacing * direction)))
      ++next;
    if (next == lattices.size()) return c;
    passed[next] = true;
    c.length += way_out(lattices[next].box, end, direction);
  }
}

// The liquid below walls, as sites that are connected.
class Covered {
 public:
  Covered(const std::vector<Lattice>& lattices, const particles::Periods& periods, const Walls& walls,
          const std::vector<FilledInside>& insides, Vec3d up)
      : lattices_(lattices), periods_(periods), walls_(walls), insides_(insides), up_(up) {
    for (const FilledInside& filled : insides) {
      double low = std::numeric_limits<double>::infinity();
      for (const Vec3d& v : filled.region.vertices) low = std::min(low, dot(v, up));
      level_.push_back(low + filled.depth);
    }
  }

  // surface: its height along `up` of each site [m] (sites), that of covered ones is set.
  void set(const std::vector<bool>& covered, std::vector<double>& surface) {
    number_.assign(covered.size(), none);
    for (const Lattice& l : lattices_) link(l, covered, surface);
    group_.resize(site_.size());
    std::iota(group_.begin(), group_.end(), 0u);
    for (const auto& [i, j] : edges_) group_[root(i)] = root(j);
    std::vector<std::vector<std::uint32_t>> members(site_.size());
    for (std::uint32_t i = 0; i < site_.size(); ++i) members[root(i)].push_back(i);
    std::vector<double> height(site_.size());
    bool several = false;  // heights at one group
    for (const auto& group : members) {
      double low = std::numeric_limits<double>::infinity(), high = -low, own = -low;
      for (const std::uint32_t i : group) {
        own = std::max(own, surface[site_[i]]);
        for (const double outside : outside_[i]) {
          low = std::min(low, outside);
          high = std::max(high, outside);
        }
      }
      const bool open = low <= high;
      several = several || (open && high > low);
      // Of several ones it is where the solution starts from.
      for (const std::uint32_t i : group) height[i] = open ? 0.5 * (low + high) : own;
    }
    if (several) solve(height);
    for (std::uint32_t i = 0; i < site_.size(); ++i) surface[site_[i]] = height[i];
  }

 private:
  static constexpr std::uint32_t none = ~0u;

  std::uint32_t number(std::size_t site) {
    if (number_[site] == none) {
      number_[site] = static_cast<std::uint32_t>(site_.size());
      site_.push_back(site);
      outside_.emplace_back();
    }
    return number_[site];
  }
  std::uint32_t root(std::uint32_t i) {
    while (group_[i] != i) i = group_[i] = group_[group_[i]];
    return i;
  }

  // The site of the box at y, also beyond an end of a periodic domain.
  std::optional<std::size_t> site_at(Vec3d y) const {
    y = periods_.wrapped(y);
    for (const Lattice& l : lattices_) {
      if (!contains(l.box, y)) continue;
      int n[3];
      for (int a = 0; a < 3; ++a)
        n[a] = std::clamp(static_cast<int>((y[a] - l.box.min[a]) / l.step[a]), 0, l.count[a] - 1);
      return l.site(n);
    }
    return std::nullopt;
  }

  void link(const Lattice& l, const std::vector<bool>& covered, const std::vector<double>& surface) {
    int n[3];
    for (n[2] = 0; n[2] < l.count[2]; ++n[2])
      for (n[1] = 0; n[1] < l.count[1]; ++n[1])
        for (n[0] = 0; n[0] < l.count[0]; ++n[0]) {
          const std::size_t here = l.site(n);
          if (!covered[here]) continue;
          const std::uint32_t i = number(here);
          for (int a = 0; a < 3; ++a)
            for (const int to : {-1, 1}) {
              Vec3d x = l.box.min;
              for (int b = 0; b < 3; ++b) x[b] += (n[b] + 0.5) * l.step[b];
              Vec3d y = x;
              y[a] += to * l.step[a];
              const bool in_box = n[a] + to >= 0 && n[a] + to < l.count[a];
              if (!in_box && walls_.between(x, y)) continue;
              if (const auto there = site_at(y)) {
                if (!covered[*there])
                  outside_[i].push_back(surface[*there]);
                else if (to > 0)
                  edges_.emplace_back(i, number(*there));
              } else {
                for (std::size_t k = 0; k < insides_.size(); ++k)
                  if (is_below(insides_[k], y, up_)) outside_[i].push_back(level_[k]);
              }
            }
        }
  }

  // The mean of the neighbours everywhere, by conjugate gradients.
  void solve(std::vector<double>& height) const {
    const std::size_t n = height.size();
    std::vector<double> residual(n), direction(n), applied(n), sum(n);
    const auto apply = [&](const std::vector<double>& of, std::vector<double>& to) {
      for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<double>(outside_[i].size()) * of[i];
      for (const auto& [i, j] : edges_) {
        to[i] += of[i] - of[j];
        to[j] += of[j] - of[i];
      }
    };
    for (std::size_t i = 0; i < n; ++i)
      for (const double outside : outside_[i]) sum[i] += outside;
    apply(height, applied);
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) {
      // A group without a surface beside it keeps its height: all of it has the same.
      residual[i] = direction[i] = sum[i] - applied[i];
      square += residual[i] * residual[i];
    }
    const double enough = 1e-20 * square;
    for (std::size_t k = 0; k < 10 * n && square > enough; ++k) {
      apply(direction, applied);
      double curvature = 0;
      for (std::size_t i = 0; i < n; ++i) curvature += direction[i] * applied[i];
      const double step = square / curvature;
      double next = 0;
      for (std::size_t i = 0; i < n; ++i) {
        height[i] += step * direction[i];
        residual[i] -= step * applied[i];
        next += residual[i] * residual[i];
      }
      for (std::size_t i = 0; i < n; ++i) direction[i] = residual[i] + next / square * direction[i];
      square = next;
    }
  }

  const std::vector<Lattice>& lattices_;
  const particles::Periods& periods_;
  const Walls& walls_;
  const std::vector<FilledInside>& insides_;
  Vec3d up_;
  std::vector<double> level_;  // of the insides, along `up` [m]
  // Covered sites are numbered.
  std::vector<std::uint32_t> number_;         // of each site
  std::vector<std::size_t> site_;             // of each number
  std::vector<std::vector<double>> outside_;  // heights of the surface of neighbours that are not covered [m]
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // between neighbours
  std::vector<std::uint32_t> group_;
};

}  // namespace

void measure_columns(const scene::Scene& scene, const LiquidSetup& setup,
                     const std::vector<particles::BodyPose>& poses, const std::vector<FilledInside>& insides,
                     Sites& sites) {
  const std::size_t n = sites.position.size();
  sites.above.assign(n, 0.0);
  sites.depth.assign(n, 0.0);
  const double g = norm(scene.gravity), spacing = scene.sph->spacing;
  if (g == 0 || n == 0) return;
  const Vec3d down = (1 / g) * scene.gravity, up = -down;
  const std::vector<Lattice> lattices = lattices_of(scene.sph->liquids.front(), spacing);
  Liquid liquid;
  liquid.spacing = spacing;
  Walls walls(setup.walls, liquid.support());
  for (std::uint32_t b = 0; b < walls.bodies(); ++b) walls.set_pose(b, poses[b]);
  std::vector<bool> covered(n);
  std::vector<double> surface(n), below(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d x = sites.position[i];
    const Column above = column(lattices, walls, x, up, spacing);
    surface[i] = dot(x, up) + above.length;
    covered[i] = above.at_wall;
    below[i] = column(lattices, walls, x, down, spacing).length;
  }
  if (std::ranges::find(covered, true) != covered.end())
    Covered(lattices, setup.periods, walls, insides, up).set(covered, surface);
  for (std::size_t i = 0; i < n; ++i) {
    // Where the surface of the liquid beside it is lower, there is no pressure.
    sites.above[i] = std::max(0.0, surface[i] - dot(sites.position[i], up));
    sites.depth[i] = sites.above[i] + below[i];
  }
}

}  // namespace tandem::sph
