// What a facet of a wall does to a particle. Behind the facet the liquid continues as ghost liquid: its
// pressure continues that of the particle linearly, its velocity is mirrored at the wall, so that the
// velocity of the wall is the mean of both. All integrals over the ghost liquid are exact
// (kernel/facet_integrals.hpp).
#pragma once

#include <cmath>

#include "common/math/rotation.hpp"
#include "sph_server/equations/liquid.hpp"
#include "sph_server/equations/spray.hpp"
#include "sph_server/kernel/facet_integrals.hpp"

namespace tandem::sph {

struct WallConstants {
  double inverse_mass = 0;  // [1/kg]
  double density = 0;       // rho0 [kg/m3]
  double viscous = 0;       // 2 mu [Pa s]
  double nearest = 0;       // distance below which the velocity of the ghost grows no further [m]

  static WallConstants of(const Liquid& l) {
    return {1 / l.mass(), l.density, 2 * l.viscosity, 0.25 * l.spacing};
  }
};

// v: velocity of the particle relative to the wall; n: normal of the facet towards the particle; distance:
// from its plane. With the integrals S of facets:
//   pressure     V 2 p_i sum of S n, of particle and ghosts
//   continuity   -2 v . sum of S n, the adjoint of the pressure: rate of compression, divided by 1 + e
//   viscosity    -V 2 mu S v_t / distance: the form of [Morris1997], integrated over a ghost with linear
//                velocity; over all distances from a plane wall its integral is the shear stress
// surface: sum of S n [1/m].
TANDEM_HD inline Vec3d wall_pressure(const WallConstants& c, Vec3d surface, double pressure, double volume) {
  return (volume * c.inverse_mass * 2 * pressure) * surface;
}
TANDEM_HD inline double wall_continuity(Vec3d surface, Vec3d v) {
  return -2 * dot(surface, v);
}
// Divided by the volume of the particle.
TANDEM_HD inline Vec3d wall_friction(const WallConstants& c, double surface, Vec3d n, double distance,
                                     Vec3d v) {
  const double gap = distance > c.nearest ? distance : c.nearest;
  return (-c.inverse_mass * c.viscous * surface / gap) * (v - dot(v, n) * n);
}

// The ghost liquid behind walls also ends at the sides of shadows, beyond edges that the liquid passes
// around. Their integral is the sum r of `rim` of all facets near a particle: sides where ghosts border on
// ghosts cancel in it, as those of facets that join. It adds to the sum of S n: without it a particle at an
// edge is not at rest under a constant pressure. Of several bodies each has the share of r that its own rim,
// `of_body`, has along r.
struct Rim {
  Vec3d sum;           // r [1/m]
  double along_r = 0;  // sum over the bodies of the parts of their rims along r, as far as positive [1/m2]

  TANDEM_HD void add_body(Vec3d of_body) { along_r += positive_part(of_body); }
  TANDEM_HD Vec3d share(Vec3d of_body) const {
    return along_r > 0 ? (positive_part(of_body) / along_r) * sum : Vec3d{};
  }

 private:
  TANDEM_HD double positive_part(Vec3d of_body) const { return std::fmax(0.0, dot(of_body, sum)); }
};

// The part of the acceleration by pressure that comes from the difference of the pressures of ghost and
// particle. Particle and ghost share the gradient of the pressure, which is -rho0 times the acceleration by
// pressure `a`. So a satisfies
//   a = a_0 - M a,   M = V rho0 / m sum over the facets of (n Y^T - B I + D)
// where a_0 is the acceleration by the pressure of particles and by 2 p_i at walls, and Y, B and D are
// integrals of a facet. I + M is the part of the identity that the kernel of the liquid represents
// [RandlesLibersky1996]. A liquid at rest, one that is accelerated with its walls and one that falls
// freely beside a wall all follow from the one rule. This adds one facet to the sum.
TANDEM_HD inline void add_missing(const FacetIntegrals& f, Vec3d n, Mat3d& sum) {
  for (int a = 0; a < 3; ++a) {
    sum.row[a] += n[a] * f.moment + f.sides.row[a];
    sum.row[a][a] -= f.shadow;
  }
}

TANDEM_HD inline Mat3d sum_of(Mat3d A, const Mat3d& B) {
  for (int a = 0; a < 3; ++a) A.row[a] += B.row[a];
  return A;
}
TANDEM_HD inline Mat3d product(double s, Mat3d A) {
  for (Vec3d& row : A.row) row *= s;
  return A;
}
TANDEM_HD inline Mat3d product(const Mat3d& A, const Mat3d& B) {
  Mat3d C;
  for (int a = 0; a < 3; ++a)
    C.row[a] = A.row[a].x * B.row[0] + A.row[a].y * B.row[1] + A.row[a].z * B.row[2];
  return C;
}
TANDEM_HD inline double norm(const Mat3d& A) {
  return std::sqrt(norm2(A.row[0]) + norm2(A.row[1]) + norm2(A.row[2]));
}

// Share of M that is taken: all of it in a liquid. Spray has no neighbours that would represent a gradient;
// behind it ghosts have its pressure. In tips and slots with hardly a neighbour I + M would be nearly
// singular: there the spectral radius of M is bounded, so that no acceleration grows more than tenfold.
// neighbours: part of the kernel that neighbours fill [-]; filled: filled_room() [-].
TANDEM_HD inline double ghost_share(double neighbours, double filled, const Mat3d& missing) {
  constexpr double one_neighbour = 0.05, most = 0.9;
  double share = tension_share(filled);
  if (neighbours < one_neighbour) share *= neighbours / one_neighbour;
  if (share * norm(missing) <= most) return share;
  // From above, and by 7 % at most: the eighth root of the norm of M^8.
  const Mat3d m2 = product(missing, missing), m4 = product(m2, m2);
  const double size = std::sqrt(std::sqrt(std::sqrt(norm(product(m4, m4)))));
  return share * size > most ? most / size : share;
}

// The solution x of A x = b; A is regular.
TANDEM_HD inline Vec3d solved(const Mat3d& A, Vec3d b) {
  const Vec3d p = cross(A.row[1], A.row[2]), q = cross(A.row[2], A.row[0]), r = cross(A.row[0], A.row[1]);
  return (1 / dot(A.row[0], p)) * (b.x * p + b.y * q + b.z * r);
}

}  // namespace tandem::sph
