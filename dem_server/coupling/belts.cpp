#include "dem_server/coupling/belts.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tandem::dem {

bool Belts::Record::is_possible() const {
  return std::isfinite(work) && std::isfinite(power) && std::isfinite(largest_power);
}

Belts::Belts(const scene::Scene& scene, const Surface& surface) : bodies_(surface.belt_wall.size()) {
  for (std::size_t body = 0; body < bodies_; ++body) {
    if (surface.belt_wall[body] == no_belt) continue;
    const scene::Wall& wall = scene.dem->walls[surface.belt_wall[body]];
    belts_.push_back({body, wall.name, wall.surface_velocity->direction,
                      scene::MotionFunction(wall.surface_velocity->speed, scene::FunctionOf::force)});
  }
}

double Belts::largest_speed(double end_time) const {
  double largest = 0;
  for (const Belt& belt : belts_)
    for (const double time : belt.speed.samples(0, end_time))
      largest = std::max(largest, std::abs(belt.speed.at(time).value));
  return largest;
}

std::span<const Vec3d> Belts::velocities(double begin, std::uint32_t steps, double dt) {
  velocity_.assign((std::size_t{steps} + 1) * bodies_, Vec3d{});
  for (const Belt& belt : belts_)
    for (std::uint32_t step = 0; step <= steps; ++step) {
      // In a window with a single step the velocities are those of its begin, and so are those of bodies.
      const double back = step == steps || steps == 1 ? 0 : 0.5;
      velocity_[step * bodies_ + belt.body] =
          belt.speed.at(std::max(0.0, begin + (step - back) * dt)).value * belt.direction;
    }
  return velocity_;
}

Vec3d Belts::velocity(std::size_t body, double time) const {
  for (const Belt& belt : belts_)
    if (belt.body == body) return belt.speed.at(time).value * belt.direction;
  return {};
}

void Belts::record(const WindowOutcome& outcome, const WindowPlan& plan, std::vector<Record>& records) const {
  for (std::size_t i = 0; i < belts_.size(); ++i) {
    double work = 0;  // against the pull of the spheres
    for (std::uint32_t step = 0; step < plan.steps; ++step) {
      const std::size_t k = step * bodies_ + belts_[i].body;
      work -= plan.dt * outcome.belt_pull[k] * norm(plan.belt_velocity[k]);
    }
    records[i].work += work;
    records[i].power = work / (plan.steps * plan.dt);
    if (std::abs(records[i].power) > std::abs(records[i].largest_power))
      records[i].largest_power = records[i].power;
  }
}

void Belts::report(const std::vector<Record>& records, nlohmann::ordered_json& others) const {
  if (!any()) return;
  double work = 0;
  for (std::size_t i = 0; i < belts_.size(); ++i) {
    others["belts"][belts_[i].name] = {{"work_J", records[i].work},
                                       {"power_W", records[i].power},
                                       {"largest_power_W", records[i].largest_power}};
    work += records[i].work;
  }
  others["belt_work_J"] = work;
}

}  // namespace tandem::dem
