#include "particles/io/inlets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "particles/io/random.hpp"

namespace tandem::particles {
namespace {

constexpr std::uint64_t most_spheres = 2147483647;

// Time at which sphere i comes in, after spheres of the total mass `before` [kg]. Window boundaries are whole
// nanoseconds; rounding makes a sphere that is due at a boundary due exactly there.
double due_time(const scene::InletFill& fill, std::uint64_t i, double before) {
  const double due =
      fill.start + (fill.rate ? static_cast<double>(i) / *fill.rate : before / *fill.mass_rate);
  return std::round(due * 1e9) / 1e9;
}

Inlet make_inlet(const scene::Scene& scene, std::size_t index) {
  const scene::ParticleGroup& group = scene.dem->particles[index];
  Inlet inlet;
  inlet.name = group.name;
  inlet.fill = std::get<scene::InletFill>(group.fill);
  inlet.group = static_cast<std::uint32_t>(index);
  inlet.velocity = group.velocity;
  const double per_volume = 4.0 / 3.0 * std::numbers::pi * scene.dem->materials[group.material.value].density;
  const std::uint64_t most = inlet.fill.count.value_or(most_spheres + 1);
  const auto refuse = [&] {
    throw Error(ErrorCode::scene, "more than 2147483647 spheres come in",
                "dem.particles[" + std::to_string(index) + "] '" + group.name + "'",
                inlet.fill.count ? "give a smaller count" : "give a count, or a smaller rate");
  };
  if (most > most_spheres && inlet.fill.count) refuse();
  // A lower bound of the number, checked before memory is allocated for the spheres.
  const double time = scene.end_time - inlet.fill.start,
               heaviest = per_volume * std::pow(group.radius_max, 3),
               least = time * (inlet.fill.rate ? *inlet.fill.rate : *inlet.fill.mass_rate / heaviest);
  if (!inlet.fill.count && least > static_cast<double>(most_spheres)) refuse();
  Random random(inlet.fill.seed);
  double mass = 0;
  for (std::uint64_t i = 0; i < most; ++i) {
    const double due = due_time(inlet.fill, i, mass);
    if (!inlet.fill.count && !(due < scene.end_time)) break;
    if (i == most_spheres) refuse();
    const double radius = random.uniform(group.radius_min, group.radius_max);
    inlet.due.push_back(due);
    inlet.radius.push_back(radius);
    mass += per_volume * radius * radius * radius;
  }
  return inlet;
}

}  // namespace

std::vector<Inlet> make_inlets(const scene::Scene& scene) {
  std::vector<Inlet> inlets;
  for (std::size_t i = 0; i < scene.dem.value().particles.size(); ++i)
    if (std::holds_alternative<scene::InletFill>(scene.dem->particles[i].fill))
      inlets.push_back(make_inlet(scene, i));
  return inlets;
}

void append_waiting(const std::vector<Inlet>& inlets, const scene::Scene& scene, Fill& fill) {
  for (const Inlet& inlet : inlets)
    for (const double radius : inlet.radius) {
      fill.position.push_back(0.5 * (inlet.fill.min + inlet.fill.max));
      fill.velocity.push_back(inlet.velocity);
      fill.spin.push_back({});
      fill.radius.push_back(radius);
      fill.material.push_back(scene.dem->particles[inlet.group].material.value);
      fill.group.push_back(inlet.group);
    }
}

}  // namespace tandem::particles
