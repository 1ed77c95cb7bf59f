#include "common/scene/time_step.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace tandem::scene {

namespace {

// Limit of central differences for an oscillator with damping ratio zeta.
double central_difference_limit(double omega, double zeta) {
  // sqrt(1 + zeta^2) - zeta without cancellation.
  return 2 / omega / (std::sqrt(1 + zeta * zeta) + zeta);
}

// For m x'' + c_lin x' + k_lin x with the linearised values of the header.
double oscillator_time(double stiffness, double damping, double overlap, double mass) {
  if (stiffness == 0) return std::numeric_limits<double>::infinity();
  return central_difference_limit(std::sqrt(1.5 * stiffness * std::sqrt(overlap) / mass),
                                  damping / (2 * std::sqrt(1.5 * stiffness * mass)));
}

}  // namespace

double rayleigh_time(double radius, const Material& material) {
  const double shear = material.young / (2 * (1 + material.poisson));
  return std::numbers::pi * radius * std::sqrt(material.density / shear) /
         (0.1631 * material.poisson + 0.8766);
}

double contact_time(double radius, double mass, const Pair& pair) {
  const double overlap = 0.05 * radius;
  return std::fmin(
      oscillator_time(pair.normal_stiffness, pair.normal_damping, overlap, mass),
      oscillator_time(pair.tangential_stiffness, pair.tangential_damping, overlap, 2.0 / 7.0 * mass));
}

bool has_own_stiffness(ContactLaw law) {
  return law == ContactLaw::paper || law == ContactLaw::hooke;
}

double hooke_damping(double restitution) {
  if (restitution <= 0) return 2;
  const double l = std::log(restitution);
  return -2 * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
}

double hooke_time(double mass, const Pair& pair) {
  const double zeta = hooke_damping(pair.restitution) / 2;
  const double normal = central_difference_limit(std::sqrt(pair.spring_stiffness / mass), zeta);
  // The tangential mass is 2/7 m; a spring of the same ratio gives the same time.
  return normal / std::sqrt(std::fmax(1.0, 3.5 * pair.spring_ratio));
}

double collision_time(const Dem& dem, MaterialId material, double radius, double speed) {
  const Material& own = dem.materials[material.value];
  const double reduced_mass = 2.0 / 3.0 * std::numbers::pi * radius * radius * radius * own.density;
  const auto compliance = [](const Material& m) { return (1 - m.poisson * m.poisson) / m.young; };
  double shortest = std::numeric_limits<double>::infinity();
  for (const Pair& pair : dem.pairs) {
    if (pair.a != material && pair.b != material) continue;
    if (dem.contact == ContactLaw::hooke) {
      shortest = std::fmin(shortest, std::numbers::pi * std::sqrt(reduced_mass / pair.spring_stiffness));
      continue;
    }
    const Material& other = dem.materials[(pair.a == material ? pair.b : pair.a).value];
    const double stiffness = dem.contact == ContactLaw::paper
                                 ? pair.normal_stiffness
                                 : 4.0 / 3.0 * std::sqrt(radius / 2) / (compliance(own) + compliance(other));
    // 2.943 = 2 times the integral of dx / sqrt(1 - x^(5/2)) from 0 to 1.
    shortest =
        std::fmin(shortest, 2.94327 * std::pow(1.25 * reduced_mass / stiffness, 0.4) * std::pow(speed, -0.2));
  }
  return shortest;
}

double critical_time(const Dem& dem, MaterialId material, double radius) {
  const Material& own = dem.materials[material.value];
  if (!has_own_stiffness(dem.contact)) return rayleigh_time(radius, own);

  // With an equal sphere the reduced mass is m / 2; a contact with a lighter sphere is counted for that
  // sphere.
  const double mass = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * own.density;
  double shortest = std::numeric_limits<double>::infinity();
  for (const Pair& pair : dem.pairs)
    if (pair.a == material || pair.b == material)
      shortest = std::fmin(shortest, dem.contact == ContactLaw::paper ? contact_time(radius, mass / 2, pair)
                                                                      : hooke_time(mass / 2, pair));
  return shortest;
}

double critical_time(const Dem& dem) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const ParticleGroup& group : dem.particles)
    if (group.radius_min > 0 && !group.fixed)
      shortest = std::fmin(shortest, critical_time(dem, group.material, group.radius_min));
  return shortest;
}

}  // namespace tandem::scene
