#include "dem_server/coupling/tangents.hpp"

#include <algorithm>

namespace tandem::dem {
namespace {

using Matrix6 = std::array<double, 36>;  // by rows

Matrix6 whole(const double* above) {
  Matrix6 m{};
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = row; column < 6; ++column) m[6 * row + column] = m[6 * column + row] = *above++;
  return m;
}

}  // namespace

std::vector<protocol::BodyTangent> body_tangents(const std::vector<WallTangent>& of_slot,
                                                 const std::vector<BodyId>& slot_body) {
  std::vector<protocol::BodyTangent> result;
  for (std::size_t slot = 0; slot < of_slot.size(); ++slot) {
    const double* entry = of_slot[slot].entry;
    const bool touched =
        std::any_of(entry, entry + WallTangent::entries, [](double value) { return value != 0; });
    if (!touched || slot_body[slot] == ground) continue;
    result.push_back({.body = slot_body[slot].value,
                      .stiffness = whole(entry),
                      .damping = whole(entry + WallTangent::of_matrix)});
  }
  return result;
}

}  // namespace tandem::dem
