#include "sph_server/engine/cut_lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

#include "common/error.hpp"
#include "particles/base/thread_pool.hpp"
#include "sph_server/engine/fill_amount.hpp"
#include "sph_server/engine/region_columns.hpp"
#include "sph_server/equations/hydrostatic.hpp"

namespace tandem::sph {
namespace {

constexpr int across = 5;  // samples along an edge of a cell
constexpr int samples = across * across * across;

// What a wall leaves of a cell on one side of it.
struct Part {
  std::uint64_t cell = 0;  // number of the cell: along the third axis, the second, the first
  double share = 0;        // of the cell [-]
  Vec3d place;             // of its particle [m]
};

// Parts of a cell that no facet separates from each other, by union and find.
class Joined {
 public:
  Joined() { std::iota(std::begin(root_), std::end(root_), 0); }
  int root(int k) const {
    while (root_[k] != k) k = root_[k];
    return k;
  }
  void join(int a, int b) {
    const int p = root(a), q = root(b);
    root_[std::max(p, q)] = std::min(p, q);
  }

 private:
  int root_[samples];
};

// Where the samples of a cell are within their own cells, from 0 to 1: others in each cell, so that a
// wall along the lattice is seen where it is. They follow from multiples of irrational numbers.
double offset(std::uint64_t cell, double irrational) {
  const double value = 0.5 + irrational * static_cast<double>(cell % 1000003);
  return value - std::floor(value);
}

class Cutter {
 public:
  Cutter(const TriangleMesh& region, const Walls& walls, const Liquid& liquid, const LatticeSpace& space)
      : walls_(walls.view()), liquid_(liquid), space_(space), columns_(region, space.axes.axis) {
    const double a = liquid.spacing;
    const Vec3d low = columns_.low(), high = columns_.high();
    height_ = space.surface - low.z;
    if (space.compressed) height_ = height_at_rest(liquid, height_);
    count_[2] = std::max(std::int64_t{1}, nearest_whole(height_ / a));
    edge_.z = height_ / static_cast<double>(count_[2]);
    edge_.x = edge_.y = std::sqrt(a * a * a / edge_.z);
    for (int k = 0; k < 2; ++k) {
      // Alike at both ends.
      const auto whole = static_cast<double>(nearest_whole((high[k] - low[k]) / edge_[k]));
      begin_[k] = 0.5 * (low[k] + high[k]) - (0.5 * whole + 1) * edge_[k];
      count_[k] = static_cast<std::int64_t>(whole) + 2;
    }
    half_diagonal_ = 0.5 * norm(edge_) * (1 + 1e-6);
  }

  // Full cells and parts of the columns of cells with this second index.
  void cut_row(std::int64_t j, std::vector<Part>& full, std::vector<Part>& parts) const {
    for (std::int64_t i = 0; i < count_[0]; ++i) {
      ColumnCrossings middle, corner[4], sample[across * across];
      columns_.find(x_of(i, 0.5), y_of(j, 0.5), middle);
      for (int c = 0; c < 4; ++c) columns_.find(x_of(i, c % 2), y_of(j, c / 2), corner[c]);
      bool sampled = false;
      for (std::int64_t k = 0; k < count_[2]; ++k) {
        const Vec3d centre = place(i, j, k, {0.5, 0.5, 0.5});
        const double bottom = z_of(k, 0), top = z_of(k, 1);
        bool whole = middle.inside(z_of(k, 0.5));
        for (const ColumnCrossings& c : corner)
          whole = whole && c.inside(bottom, true) && c.inside(top, false);
        const std::vector<std::uint32_t> facets = facets_near(centre);
        const std::uint64_t cell = cell_of(i, j, k);
        if (whole && facets.empty()) {
          full.push_back({cell, 1, centre});
          continue;
        }
        if (!sampled)
          for (int s = 0; s < across * across; ++s)
            columns_.find(x_of(i, (s % across + shift(i, j, 0)) / across),
                          y_of(j, (s / across + shift(i, j, 1)) / across), sample[s]);
        sampled = true;
        cut_cell(i, j, k, sample, facets, full, parts);
      }
    }
  }

  std::int64_t rows() const { return count_[1]; }

  // Parts next to a part that come after it and that no wall separates from it.
  template <class Each>
  void for_next(const std::vector<Part>& parts, std::size_t from, Each each) const {
    const Part& part = parts[from];
    const auto number = static_cast<std::int64_t>(part.cell);
    const std::int64_t here[2] = {number % count_[0], number / count_[0] % count_[1]};
    for (int n = 14; n < 27; ++n) {
      const std::int64_t step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      bool exists = true;
      for (int a = 0; a < 2; ++a) exists = exists && here[a] + step[a] >= 0 && here[a] + step[a] < count_[a];
      if (!exists) continue;
      const auto cell =
          static_cast<std::uint64_t>(number + step[0] + count_[0] * (step[1] + count_[1] * step[2]));
      auto next = std::ranges::lower_bound(parts, cell, {}, &Part::cell);
      for (; next != parts.end() && next->cell == cell; ++next)
        if (!walls_.between(part.place, next->place)) each(static_cast<std::size_t>(next - parts.begin()));
    }
  }

 private:
  double x_of(std::int64_t i, double within) const {
    return begin_[0] + (static_cast<double>(i) + within) * edge_.x;
  }
  double y_of(std::int64_t j, double within) const {
    return begin_[1] + (static_cast<double>(j) + within) * edge_.y;
  }
  double z_of(std::int64_t k, double within) const {
    const double below = (static_cast<double>(k) + within) * edge_.z;
    const double height = below < height_ ? height_ - below : 0;
    return space_.surface - (space_.compressed ? depth_at_rest(liquid_, height) : height);
  }
  Vec3d place(std::int64_t i, std::int64_t j, std::int64_t k, Vec3d within) const {
    return x_of(i, within.x) * space_.axes.axis[0] + y_of(j, within.y) * space_.axes.axis[1] +
           z_of(k, within.z) * space_.axes.axis[2];
  }
  std::uint64_t cell_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::uint64_t>((k * count_[1] + j) * count_[0] + i);
  }
  double shift(std::int64_t i, std::int64_t j, int axis) const {
    return offset(cell_of(i, j, 0), axis == 0 ? 0.7548776662466927 : 0.5698402909980532);
  }

  std::vector<std::uint32_t> facets_near(Vec3d x) const {
    std::vector<std::uint32_t> found;
    walls_.for_near(x, half_diagonal_, [&](std::uint32_t number) {
      if (walls_.is_within(half_diagonal_, x, number)) found.push_back(number);
      return true;
    });
    return found;
  }

  void cut_cell(std::int64_t i, std::int64_t j, std::int64_t k, const ColumnCrossings* column,
                const std::vector<std::uint32_t>& facets, std::vector<Part>& full,
                std::vector<Part>& parts) const {
    const std::uint64_t cell = cell_of(i, j, k);
    const Vec3d first{shift(i, j, 0), shift(i, j, 1), offset(cell, 0.618033988749895)};
    Vec3d x[samples];
    bool in[samples];
    int all = 0;
    for (int s = 0; s < samples; ++s) {
      const int at[3] = {s % across, s / across % across, s / (across * across)};
      Vec3d within;
      for (int a = 0; a < 3; ++a) within[a] = (at[a] + first[a]) / across;
      x[s] = place(i, j, k, within);
      in[s] = column[at[1] * across + at[0]].inside(z_of(k, within.z));
      all += in[s] ? 1 : 0;
    }
    if (all == 0) return;
    Joined joined;
    const auto separate = [&](int s, int t) {
      return std::ranges::any_of(facets, [&](std::uint32_t f) { return walls_.between(f, x[s], x[t]); });
    };
    for (int s = 0; s < samples; ++s) {
      if (!in[s]) continue;
      int stride = 1;
      for (int a = 0; a < 3; ++a, stride *= across)
        if (s / stride % across + 1 < across && in[s + stride] && joined.root(s) != joined.root(s + stride) &&
            !separate(s, s + stride))
          joined.join(s, s + stride);
    }
    for (int root = 0; root < samples; ++root) {
      if (!in[root] || joined.root(root) != root) continue;
      Vec3d sum;
      int number = 0;
      for (int s = root; s < samples; ++s)
        if (in[s] && joined.root(s) == root) sum += x[s], ++number;
      if (number == samples) {
        full.push_back({cell, 1, place(i, j, k, {0.5, 0.5, 0.5})});
        return;
      }
      const Vec3d middle = (1.0 / number) * sum;
      int nearest = root;
      for (int s = root; s < samples; ++s)
        if (in[s] && joined.root(s) == root && norm2(x[s] - middle) < norm2(x[nearest] - middle) * (1 - 1e-9))
          nearest = s;
      parts.push_back({cell, static_cast<double>(number) / samples, x[nearest]});
    }
  }

  WallsView walls_;
  const Liquid& liquid_;
  const LatticeSpace& space_;
  RegionColumns columns_;
  double height_ = 0;  // of all layers [m]
  std::int64_t count_[3]{};
  double begin_[2]{};  // [m]
  Vec3d edge_;         // of a cell [m]
  double half_diagonal_ = 0;
};

// All cells in the region, in their order.
struct Cells {
  std::vector<Part> full, parts;

  // Ends early where stop() says so; found() is called where a cell is cut.
  Cells(
      const Cutter& cutter, unsigned threads, const std::function<bool()>& stop,
      const std::function<void()>& found = [] {}) {
    particles::ThreadPool pool(threads);
    struct Row {
      std::vector<Part> full, parts;
    };
    std::vector<Row> rows(static_cast<std::size_t>(cutter.rows()));
    pool.run([&](unsigned thread) {
      for (std::size_t j = thread; j < rows.size() && !stop(); j += pool.size()) {
        cutter.cut_row(static_cast<std::int64_t>(j), rows[j].full, rows[j].parts);
        if (!rows[j].parts.empty()) found();
      }
    });
    for (const Row& row : rows) {
      full.insert(full.end(), row.full.begin(), row.full.end());
      parts.insert(parts.end(), row.parts.begin(), row.parts.end());
    }
    std::ranges::stable_sort(full, {}, &Part::cell);
    std::ranges::stable_sort(parts, {}, &Part::cell);
  }
};

// Which parts have a particle: what a part has too much or too little goes to the next ones.
std::vector<bool> chosen(const Cutter& cutter, const std::vector<Part>& parts, double wanted, double room) {
  std::vector<double> due(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) due[p] = parts[p].share * (room > 0 ? wanted / room : 0);
  std::vector<bool> chosen(parts.size());
  double left = 0;  // of parts without a next one
  std::vector<std::size_t> next;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    double value = due[p] + left;
    left = 0;
    chosen[p] = value > 0.4871;
    if (chosen[p]) value -= 1;
    next.clear();
    cutter.for_next(parts, p, [&](std::size_t n) { next.push_back(n); });
    if (next.empty()) left = value;
    for (const std::size_t n : next) due[n] += value / static_cast<double>(next.size());
  }
  return chosen;
}

}  // namespace

LatticeAxes lattice_axes(Vec3d up, const Mat3d& region_axes) {
  int least = 0;
  const Vec3d in_region = region_axes.transpose_times(up);
  for (int a = 1; a < 3; ++a)
    if (std::fabs(in_region[a]) < std::fabs(in_region[least]) - 1e-9) least = a;
  Vec3d along;
  along[least] = 1;
  along = region_axes * along;
  LatticeAxes axes;
  axes.axis[0] = normalized(along - dot(along, up) * up);
  axes.axis[1] = cross(up, axes.axis[0]);
  axes.axis[2] = up;
  return axes;
}

std::vector<Vec3d> cut_lattice(const TriangleMesh& region, const Walls& walls, const Liquid& liquid,
                               const LatticeSpace& space, std::size_t particles, unsigned threads) {
  const Cutter cutter(region, walls, liquid, space);
  const Cells cells(cutter, threads, [] { return false; });
  const std::vector<Part>& parts = cells.parts;
  const double left = static_cast<double>(particles) - static_cast<double>(cells.full.size());
  double room = 0;
  for (const Part& part : parts) room += part.share;
  // The shares are those of samples.
  if (!(std::fabs(left - room) <= 1 + 0.15 * room))
    throw Error(ErrorCode::scene,
                fmt::format("{} particles of the liquid's mass, and its walls leave room for {:.0f}",
                            particles, static_cast<double>(cells.full.size()) + room),
                "fill", "let closed walls in the liquid be apart from each other, or take a smaller spacing");
  std::vector<bool> takes = chosen(cutter, parts, left, room);
  // What the last parts were due, by rounding less than a particle.
  auto number = cells.full.size() + static_cast<std::size_t>(std::ranges::count(takes, true));
  const auto change = [&](bool to) {
    std::size_t best = parts.size();
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (takes[p] != to && (best == parts.size() ||
                             (to ? parts[p].share > parts[best].share : parts[p].share < parts[best].share)))
        best = p;
    if (best == parts.size())
      throw Error(ErrorCode::scene, "a region that is narrower than a spacing of the liquid", "fill",
                  "take a smaller spacing");
    takes[best] = to;
  };
  for (; number < particles; ++number) change(true);
  for (; number > particles; --number) change(false);
  // In the order of the cells.
  std::vector<Vec3d> places;
  std::size_t p = 0;
  const auto take_parts = [&](std::uint64_t before) {
    for (; p < parts.size() && parts[p].cell < before; ++p)
      if (takes[p]) places.push_back(parts[p].place);
  };
  for (const Part& part : cells.full) {
    take_parts(part.cell);
    places.push_back(part.place);
  }
  take_parts(std::numeric_limits<std::uint64_t>::max());
  return places;
}

std::vector<Vec3d> whole_lattice(const TriangleMesh& region, const Walls& walls, const Liquid& liquid,
                                 const LatticeSpace& space, std::size_t particles, unsigned threads) {
  const Cutter cutter(region, walls, liquid, space);
  std::atomic<bool> cut = false;
  Cells cells(
      cutter, threads, [&] { return cut.load(); }, [&] { cut = true; });
  std::vector<Vec3d> places;
  if (!cells.parts.empty() || cells.full.size() != particles) return places;
  for (const Part& part : cells.full) places.push_back(part.place);
  return places;
}

}  // namespace tandem::sph
