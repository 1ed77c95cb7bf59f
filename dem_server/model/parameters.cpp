#include "dem_server/model/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace tandem::dem {

namespace {

// alpha = -sqrt(5) ln e / sqrt(ln^2 e + pi^2) solves the damped Hertz impact exactly (Antypov and Elliott 2011,
// EPL 94:50004, eq. 17); our damping force is alpha sqrt(m* k_h) delta^(1/4) u_n with k_h = 4/3 E* sqrt(R*).
// e = 0 has no finite ln; its limit is sqrt(5).
double tsuji_alpha(double e) {
  if (e <= 0) return std::sqrt(5.0);
  const double l = std::log(e);
  return -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
}

}  // namespace

template <class Real>
Parameters<Real> make_parameters(const scene::Scene& scene, std::size_t spheres, double largest_radius, double extent) {
  const scene::Dem& dem = *scene.dem;
  if (dem.materials.size() > max_materials)
    throw Error(ErrorCode::scene, std::to_string(dem.materials.size()) + " materials", "dem.materials",
                "this build holds " + std::to_string(max_materials) + "; raise max_materials in parameters.hpp");
  Parameters<Real> p;
  p.materials = static_cast<std::uint32_t>(dem.materials.size());
  p.law = static_cast<std::uint32_t>(dem.contact);
  p.gravity = scene.gravity;
  p.domain_min = dem.domain.min;
  p.domain_max = dem.domain.max;
  double stiffest = 0, heaviest = 0;
  for (std::size_t m = 0; m < dem.materials.size(); ++m) {
    const double per_volume = 4.0 / 3.0 * std::numbers::pi * dem.materials[m].density;
    p.mass_per_volume[m] = static_cast<Real>(per_volume);
    heaviest = std::max(heaviest, per_volume * largest_radius * largest_radius * largest_radius);
  }
  for (const scene::Pair& pair : dem.pairs) {
    const scene::Material &a = dem.materials[pair.a.value], &b = dem.materials[pair.b.value];
    const double e_star =
        1 / ((1 - a.poisson * a.poisson) / a.young + (1 - b.poisson * b.poisson) / b.young);
    const double shear_a = a.young / (2 * (1 + a.poisson)), shear_b = b.young / (2 * (1 + b.poisson));
    PairConstants<Real> c;
    c.e_star = static_cast<Real>(e_star);
    c.g_star = static_cast<Real>(1 / ((2 - a.poisson) / shear_a + (2 - b.poisson) / shear_b));
    c.damping = static_cast<Real>(tsuji_alpha(pair.restitution));
    c.friction = static_cast<Real>(pair.friction);
    c.k_n = static_cast<Real>(pair.normal_stiffness);
    c.c_n = static_cast<Real>(pair.normal_damping);
    c.k_t = static_cast<Real>(pair.tangential_stiffness);
    c.c_t = static_cast<Real>(pair.tangential_damping);
    p.pair[pair.a.value * max_materials + pair.b.value] = c;
    p.pair[pair.b.value * max_materials + pair.a.value] = c;
    stiffest = std::max({stiffest, 4.0 / 3.0 * e_star * std::sqrt(largest_radius), pair.normal_stiffness});
  }
  // Range of the exact sums: every sphere pressed a tenth of its radius into one wall, a thousand times its weight on
  // it, or leaving the domain at 1e4 m/s, whichever is most. Within that range the quantum is below 1e-15 of the sum.
  const double n = static_cast<double>(std::max<std::size_t>(spheres, 1));
  const double depth = 0.1 * largest_radius;
  const double single =
      std::max({stiffest * depth * std::sqrt(depth), 1e3 * heaviest * norm(scene.gravity), 1e4 * heaviest});
  p.force = Quantum::for_range(n * single);
  p.torque = Quantum::for_range(n * single * extent);
  p.force_limit = n * single;
  p.speed_limit = 1e5F;
  return p;
}

template Parameters<float> make_parameters(const scene::Scene&, std::size_t, double, double);
template Parameters<double> make_parameters(const scene::Scene&, std::size_t, double, double);

}  // namespace tandem::dem
