#include "common/scene/lattice.hpp"

#include <cmath>
#include <numbers>

namespace tandem::scene {

namespace {

// Number of sites at `first`, `first + pitch`, ... up to `last`. A site that exceeds it by rounding only
// counts.
double sites_along(double first, double last, double pitch) {
  constexpr double rounding = 1e-9;
  return std::fmax(0, std::floor((last - first) / pitch + rounding) + 1);
}

struct Rows {
  Vec3d first, last;                               // [m] corners of the box that holds the centres
  double row, layer;                               // [m] distance of rows along y and of layers along z
  double row_shift, layer_shift_x, layer_shift_y;  // [m]
  double spacing;                                  // [m] along x

  Rows(const LatticeFill& fill, double radius) {
    const Vec3d margin{radius, radius, radius};
    first = fill.min + margin;
    last = fill.max - margin;
    spacing = fill.spacing;
    const bool hexagonal = fill.lattice == "hexagonal";
    row = hexagonal ? spacing * std::numbers::sqrt3 / 2 : spacing;
    layer = hexagonal ? spacing * std::sqrt(2.0 / 3.0) : spacing;
    row_shift = hexagonal ? spacing / 2 : 0;
    layer_shift_x = hexagonal ? spacing / 2 : 0;
    layer_shift_y = hexagonal ? spacing * std::numbers::sqrt3 / 6 : 0;
  }

  double layers() const { return sites_along(first.z, last.z, layer); }
  double y_of_layer(bool odd_layer) const { return first.y + (odd_layer ? layer_shift_y : 0); }
  double rows(bool odd_layer) const { return sites_along(y_of_layer(odd_layer), last.y, row); }
  // The two shifts cancel: an odd row of an odd layer begins at the x of an even row of an even layer.
  double x_of_row(bool odd_layer, bool odd_row) const {
    return first.x + (odd_layer == odd_row ? 0 : odd_layer ? layer_shift_x : row_shift);
  }
  double columns(bool odd_layer, bool odd_row) const {
    return sites_along(x_of_row(odd_layer, odd_row), last.x, spacing);
  }

  double in_layer(bool odd_layer) const {
    const double all = rows(odd_layer), odd = std::floor(all / 2);
    return (all - odd) * columns(odd_layer, false) + odd * columns(odd_layer, true);
  }
};

}  // namespace

double lattice_capacity(const LatticeFill& fill, double radius) {
  const Rows rows(fill, radius);
  const double all = rows.layers(), odd = std::floor(all / 2);
  return (all - odd) * rows.in_layer(false) + odd * rows.in_layer(true);
}

std::vector<Vec3d> lattice_sites(const LatticeFill& fill, double radius, std::uint64_t count) {
  const Rows rows(fill, radius);
  std::vector<Vec3d> sites;
  sites.reserve(count);
  for (std::uint64_t k = 0; static_cast<double>(k) < rows.layers(); ++k) {
    const bool odd_layer = k % 2 == 1;
    const double z = rows.first.z + static_cast<double>(k) * rows.layer;
    for (std::uint64_t j = 0; static_cast<double>(j) < rows.rows(odd_layer); ++j) {
      const bool odd_row = j % 2 == 1;
      const double y = rows.y_of_layer(odd_layer) + static_cast<double>(j) * rows.row;
      const double x = rows.x_of_row(odd_layer, odd_row);
      for (std::uint64_t i = 0; static_cast<double>(i) < rows.columns(odd_layer, odd_row); ++i) {
        if (sites.size() == count) return sites;
        sites.push_back({x + static_cast<double>(i) * rows.spacing, y, z});
      }
    }
  }
  return sites;
}

}  // namespace tandem::scene
