#include "dem_server/coupling/tangents.hpp"

#include <algorithm>

namespace tandem::dem {
namespace {

using Matrix6 = std::array<double, 36>;  // by rows

Matrix6 symmetric(const double* above) {
  Matrix6 m{};
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = row; column < 6; ++column) m[6 * row + column] = m[6 * column + row] = *above++;
  return m;
}

}  // namespace

std::vector<protocol::BodyTangent> body_tangents(const std::vector<WallTangent>& of_body,
                                                 const std::vector<BodyId>& boundary_bodies) {
  std::vector<protocol::BodyTangent> result;
  for (std::size_t body = 0; body < of_body.size(); ++body) {
    const double* entry = of_body[body].entry;
    const bool touched =
        std::any_of(entry, entry + WallTangent::entries, [](double value) { return value != 0; });
    if (!touched || boundary_bodies[body] == ground) continue;
    result.push_back({.body = boundary_bodies[body].value,
                      .stiffness = symmetric(entry),
                      .damping = symmetric(entry + WallTangent::of_matrix)});
  }
  return result;
}

}  // namespace tandem::dem
