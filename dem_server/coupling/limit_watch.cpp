#include "dem_server/coupling/limit_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dem_server/laws/step_limits.hpp"
#include "dem_server/laws/stiffer.hpp"

namespace tandem::dem {

LimitWatch::LimitWatch(const scene::Dem& dem, const Spheres& spheres) : dem_(dem) {
  for (std::uint32_t m = 0; m < dem.materials.size(); ++m) {
    double radius = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i)
      if (spheres.material[i] == m) radius = std::min(radius, spheres.radius[i]);
    if (std::isfinite(radius)) smallest_.push_back({MaterialId{m}, radius});
  }
}

double LimitWatch::collision_time(double closing_speed) const {
  double shortest = std::numeric_limits<double>::infinity();
  if (closing_speed <= 0) return shortest;
  for (const Smallest& s : smallest_)
    shortest = std::min(shortest, dem::collision_time(dem_, s.material, s.radius, closing_speed));
  return shortest;
}

double LimitWatch::smallest_radius() const {
  double radius = std::numeric_limits<double>::infinity();
  for (const Smallest& s : smallest_) radius = std::min(radius, s.radius);
  return radius;
}

double LimitWatch::crossing_time(double closing_speed) const {
  return closing_speed > 0 ? smallest_radius() / closing_speed : std::numeric_limits<double>::infinity();
}

double LimitWatch::expected_speed(const Spheres& spheres, Vec3d gravity) const {
  const double g = norm(gravity);
  double fastest = 0, fall = 0;  // [m/s] [m]
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    fastest = std::max(fastest, norm(spheres.velocity[i]));
    if (g == 0) continue;
    // Distance to the end of the domain in the direction of gravity [m]. Periodic directions have no end.
    double below = 0;
    for (int a = 0; a < 3; ++a) {
      if (dem_.periodic[static_cast<std::size_t>(a)]) continue;
      const double along = gravity[a] / g, x = spheres.position[i][a];
      below += along > 0 ? along * (dem_.domain.max[a] - x) : along * (dem_.domain.min[a] - x);
    }
    fall = std::max(fall, below);
  }
  return std::sqrt(fastest * fastest + 2 * g * fall);
}

std::vector<std::string> LimitWatch::observe(const WindowOutcome& outcome, const WindowPlan& plan,
                                             double time, Record& record) {
  std::vector<std::string> news;
  // A window that is repeated counts once, since a rollback restores `record`, and is reported once.
  const auto note = [&news](std::uint64_t& count, bool& warned, bool beyond, auto sentence) {
    if (!beyond) return;
    ++count;
    if (!std::exchange(warned, true)) news.push_back(sentence());
  };
  ++record.windows;
  record.overlap = std::max(record.overlap, outcome.max_overlap_ratio);
  record.speed = std::max(record.speed, outcome.max_speed);
  // Two spheres collide head on, or a sphere collides with a wall that moves towards it.
  const double closing = outcome.max_speed + std::max(outcome.max_speed, plan.body_speed);
  record.closing_speed = std::max(record.closing_speed, closing);
  note(record.beyond_overlap, warned_overlap_, outcome.max_overlap_ratio > dem_.overlap_limit, [&] {
    return fmt::format(
        "t = {:.6g} s: an overlap of {:.3g} of the smaller radius is beyond dem.overlap_limit, {:.3g}: use "
        "{}",
        time, outcome.max_overlap_ratio, dem_.overlap_limit,
        stiffer(dem_, dem_.overlap_limit / outcome.max_overlap_ratio));
  });
  const double speed_limit = dem_.speed_limit.value_or(std::numeric_limits<double>::infinity());
  note(record.beyond_speed, warned_speed_, outcome.max_speed > speed_limit, [&] {
    return fmt::format(
        "t = {:.6g} s: a speed of {:.4g} m/s is beyond dem.speed_limit, {:.4g} m/s: use a shorter "
        "dem.micro_step than {:.3g} s, or a higher limit if it is meant",
        time, outcome.max_speed, speed_limit, plan.dt);
  });
  const double duration = collision_time(closing), crossing = crossing_time(closing);
  const bool unresolved = plan.dt > largest_collision_share * duration,
             passing = plan.dt > largest_travel_share * crossing;
  if (unresolved || passing) {
    const double step = std::min(automatic_collision_share * duration, automatic_travel_share * crossing);
    record.step = record.step > 0 ? std::min(record.step, step) : step;
  }
  std::uint64_t once = 0;  // a window counts once, even if its steps are too long for both reasons
  note(once, warned_step_, unresolved, [&] {
    return fmt::format(
        "t = {:.6g} s: spheres of {:.4g} m/s may collide within {:.3g} s, {:.2g} micro steps of {:.3g} s: "
        "use dem.micro_step "
        "= {:.3g}",
        time, outcome.max_speed, duration, duration / plan.dt, plan.dt, record.step);
  });
  note(once, warned_travel_, passing, [&] {
    return fmt::format(
        "t = {:.6g} s: with spheres of up to {:.4g} m/s and walls of up to {:.4g} m/s two may come nearer by "
        "{:.3g} m in a micro step of {:.3g} s, the smallest radius being {:.3g} m, and pass each other "
        "undetected: use dem.micro_step = {:.3g}",
        time, outcome.max_speed, plan.body_speed, closing * plan.dt, plan.dt, smallest_radius(), record.step);
  });
  if (once > 0) ++record.beyond_step;
  return news;
}

bool LimitWatch::Record::is_possible() const {
  for (const double figure : {overlap, speed, closing_speed, step})
    if (!(std::isfinite(figure) && figure >= 0)) return false;
  return true;
}

std::vector<std::string> LimitWatch::warnings(const Record& record) const {
  std::vector<std::string> all;
  if (record.beyond_overlap > 0)
    all.push_back(
        fmt::format("{} of {} windows had overlaps beyond dem.overlap_limit, {:.3g}; the largest overlap was "
                    "{:.3g} of the smaller "
                    "radius; contact laws are meant for a few per cent: use {}",
                    record.beyond_overlap, record.windows, dem_.overlap_limit, record.overlap,
                    stiffer(dem_, dem_.overlap_limit / record.overlap)));
  if (record.beyond_speed > 0)
    all.push_back(fmt::format(
        "{} of {} windows had spheres faster than dem.speed_limit, {:.4g} m/s; the fastest had {:.4g}: use a "
        "shorter dem.micro_step, or a limit above that if it is meant",
        record.beyond_speed, record.windows, *dem_.speed_limit, record.speed));
  if (record.beyond_step == 0) return all;
  // With stiff spheres a step is too long for a collision before spheres can pass each other.
  const bool undetected = largest_travel_share * crossing_time(record.closing_speed) <
                          largest_collision_share * collision_time(record.closing_speed);
  all.push_back(fmt::format(
      "in {} of {} windows fewer than {:.0f} micro steps would resolve the fastest collision that was "
      "possible, of spheres closing with {:.4g} m/s{}: use dem.micro_step = {:.3g}",
      record.beyond_step, record.windows, 1 / largest_collision_share, record.closing_speed,
      undetected
          ? fmt::format(", or a step may bring two nearer by more than half the smallest radius, {:.3g} m, "
                        "so that they pass each other undetected",
                        smallest_radius())
          : "",
      record.step));
  return all;
}

}  // namespace tandem::dem
