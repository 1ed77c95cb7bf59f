#include "dem_server/coupling/tangents.hpp"

#include <algorithm>

namespace tandem::dem {
namespace {

using Matrix6 = std::array<double, 36>;  // by rows

// The contact moves by J x with x = (displacement, turn) of the body, J = [I,
// -[arm]], and answers by C = normal n n^T + across (I - n n^T): adds J^T C J.
void add(Matrix6& sum, const ContactTangent& contact, double normal, double across) {
  for (int column = 0; column < 6; ++column) {
    Vec3d unit;
    unit[column % 3] = 1;
    const Vec3d moved = column < 3 ? unit : cross(unit, contact.arm);
    const Vec3d force = across * moved + (normal - across) * dot(moved, contact.normal) * contact.normal;
    const Vec3d torque = cross(contact.arm, force);
    for (int row = 0; row < 3; ++row) {
      sum[static_cast<std::size_t>(6 * row + column)] += force[row];
      sum[static_cast<std::size_t>(6 * (row + 3) + column)] += torque[row];
    }
  }
}

}  // namespace

std::vector<protocol::BodyTangent> sum_tangents(const std::vector<ContactTangent>& contacts,
                                                const std::vector<BodyId>& slot_body) {
  std::vector<protocol::BodyTangent> of_slot(slot_body.size());
  std::vector<bool> touched(slot_body.size());
  for (const ContactTangent& contact : contacts) {
    touched[contact.slot] = true;
    add(of_slot[contact.slot].stiffness, contact, contact.k_n, contact.k_t);
    add(of_slot[contact.slot].damping, contact, contact.d_n, contact.d_t);
  }
  std::vector<protocol::BodyTangent> result;
  for (std::size_t slot = 0; slot < slot_body.size(); ++slot) {
    if (!touched[slot] || slot_body[slot] == ground) continue;
    result.push_back(of_slot[slot]);
    result.back().body = slot_body[slot].value;
  }
  return result;
}

}  // namespace tandem::dem
