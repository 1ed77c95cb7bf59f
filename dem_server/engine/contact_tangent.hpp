// Derivatives of the forces of contacts of spheres with walls with respect to a small motion of the wall.
#pragma once

#include "common/math/vec3.hpp"

namespace tandem::dem {

// Of one contact.
struct ContactTangent {
  Vec3d arm;                // from the origin of the wall's body to the contact, world axes [m]
  Vec3d normal;             // from the wall to the sphere, world axes [-]
  double k_n = 0, k_t = 0;  // stiffness along the normal and across it [N/m]
  double d_n = 0, d_t = 0;  // damping, likewise [N s/m]
};

// Sum over contacts of one body: two matrices (6 x 6) with respect to its displacement and rotation vector,
// world axes. Both are symmetric. `entry` holds the entries on and above the diagonal, by rows, of the
// stiffness and then of the damping.
struct WallTangent {
  static constexpr int of_matrix = 21, entries = 2 * of_matrix;
  double entry[entries]{};
};

// The contact point moves by J x with x = (displacement, rotation vector) of the body and J = [I, -[arm]x].
// The stiffness of the contact is C = k_n n n^T + k_t (I - n n^T), and its damping likewise. Adds
//   J^T C J = k_t J^T J + (k_n - k_t) w w^T,  w = J^T n = (n, arm x n).
TANDEM_HD inline void add(const ContactTangent& contact, WallTangent& sum) {
  const Vec3d a = contact.arm, n = contact.normal, moment = cross(a, n);
  const double w[6] = {n.x, n.y, n.z, moment.x, moment.y, moment.z};
  const double xx = a.x * a.x, yy = a.y * a.y, zz = a.z * a.z;
  // clang-format off
  const double levers[WallTangent::of_matrix] = {1, 0, 0,       0,      a.z,       -a.y,
                                                    1, 0,    -a.z,        0,        a.x,
                                                       1,     a.y,     -a.x,          0,
                                                          yy + zz, -a.x * a.y, -a.x * a.z,
                                                                      xx + zz, -a.y * a.z,
                                                                                  xx + yy};
  // clang-format on
  for (int row = 0, k = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column, ++k) {
      const double along = w[row] * w[column];
      sum.entry[k] += contact.k_t * levers[k] + (contact.k_n - contact.k_t) * along;
      sum.entry[WallTangent::of_matrix + k] += contact.d_t * levers[k] + (contact.d_n - contact.d_t) * along;
    }
}

}  // namespace tandem::dem
