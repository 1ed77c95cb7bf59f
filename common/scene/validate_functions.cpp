// Functions of time: the checks of validate() and the remarks of warnings().
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/math/interpolation.hpp"
#include "common/scene/motion_function.hpp"
#include "common/scene/parse.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

bool gives_position(MotionOf of, FunctionOf what) {
  return what == FunctionOf::coordinate && of == MotionOf::position;
}

void validate_table(const TableMotion& table, FunctionOf what, const std::string& origin,
                    const std::string& path) {
  if (table.times.size() != table.values.size())
    fail(origin, path + ".values",
         std::to_string(table.values.size()) + " values for " + std::to_string(table.times.size()) + " times",
         "give one value for each time");
  for (std::size_t k = 1; k < table.times.size(); ++k) {
    const double last = table.times[k - 1], shortest = shortest_change(last, gives_position(table.of, what));
    if (!(table.times[k] > last))
      fail(origin, element(path + ".times", k),
           exact_text(table.times[k]) + " s does not come after " + exact_text(last) + " s",
           "times must increase");
    if (table.times[k] - last < shortest)
      fail(origin, element(path + ".times", k),
           fmt::format("{} s is {:.2g} s after {} s, and a change takes {:.2g} s or more there",
                       text(table.times[k]), table.times[k] - last, text(last), shortest),
           "give times that are further apart, or one time with \"interpolation\": \"step\"");
  }
}

void validate_ramp(const RampMotion& ramp, FunctionOf what, const std::string& origin,
                   const std::string& path) {
  if (const double shortest = shortest_change(ramp.start, gives_position(ramp.of, what));
      ramp.duration < shortest)
    fail(origin, path + ".duration",
         fmt::format("{} s is too short for a change at {} s", text(ramp.duration), text(ramp.start)),
         fmt::format("give {:.2g} s or more", shortest));
}

// The acceleration of a prescribed coordinate is continuous: corners and steps need a smoothing time.
void validate_smoothing(const TableMotion& table, const std::string& origin, const std::string& path) {
  const bool linear = table.interpolation == Interpolation::linear;
  if (!linear && table.interpolation != Interpolation::step) {
    if (table.smoothing != 0)
      fail(origin, path + ".smoothing",
           "a table that is neither linear nor stepped is given " + text(table.smoothing) + " s",
           "leave it out, or add \"interpolation\": \"linear\" or \"step\"");
    return;
  }
  double shortest = HUGE_VAL;
  for (std::size_t k = 1; k < table.times.size(); ++k)
    shortest = std::min(shortest, table.times[k] - table.times[k - 1]);
  if (table.smoothing == 0)
    fail(origin, path + ".interpolation",
         std::string("a motion with ") + (linear ? "corners" : "steps") + " has no acceleration there",
         "add \"smoothing\": a time up to " + text(shortest) +
             " s, the shortest between two times, or write \"monotone\"");
  if (table.smoothing > shortest)
    fail(origin, path + ".smoothing",
         text(table.smoothing) + " s is longer than the shortest time between two values, " + text(shortest) +
             " s",
         "give that or less");
  if (const double least = shortest_change(table.times.back(), table.of == MotionOf::position);
      table.smoothing < least)
    fail(origin, path + ".smoothing", text(table.smoothing) + " s is too short for a change",
         fmt::format("give {:.2g} s or more", least));
}

void validate_offset(MotionOf of, double offset, const std::string& origin, const std::string& path) {
  if (of == MotionOf::position && offset != 0)
    fail(origin, path + ".offset",
         "the motion gives positions, and an offset of " + text(offset) + " as well",
         "leave it out, or add \"of\": \"speed\"");
}

// A stop cannot hold a prescribed coordinate.
void validate_travel(const Joint& joint, double end_time, const std::string& origin,
                     const std::string& path) {
  const MotionFunction motion(*joint.motion);
  const Limits& limits = *joint.limits;
  const double slack = 1e-9 * std::max(limits.upper - limits.lower, std::abs(limits.upper));
  const auto beyond = [&](double q) { return std::max(q - limits.upper, limits.lower - q) - slack; };
  const std::vector<double> times = motion.samples(0, end_time);
  const auto out =
      std::find_if(times.begin(), times.end(), [&](double t) { return beyond(motion.at(t).value) > 0; });
  if (out == times.end()) return;
  double inside = out == times.begin() ? *out : *std::prev(out), outside = *out;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (inside + outside);
    (beyond(motion.at(middle).value) > 0 ? outside : inside) = middle;
  }
  double furthest = *out;
  for (const double t : times)
    if (beyond(motion.at(t).value) > beyond(motion.at(furthest).value)) furthest = t;
  const double reached = motion.at(furthest).value;
  const bool above = reached > limits.upper;
  fail(origin, path,
       fmt::format("the motion of joint '{}' leaves its limits at t = {:.6g} s: at t = {:.6g} s it is at "
                   "{:.6g}, {} the {} limit of {:.6g}",
                   joint.name, outside, furthest, reached, above ? "above" : "below",
                   above ? "upper" : "lower", above ? limits.upper : limits.lower),
       "a stop does not hold a prescribed coordinate: change the motion, or move or leave out the limits");
}

// `where` names the joint or the force.
void warn_of_overshoot(const Motion& motion, FunctionOf what, const std::string& where,
                       std::vector<std::string>& warnings) {
  const auto* table = std::get_if<TableMotion>(&motion);
  if (!table || table->interpolation != Interpolation::spline) return;
  const Overshoot over = largest_overshoot(table_curve(*table, what), table->times, table->values);
  if (over.size == 0) return;
  warnings.push_back(fmt::format(
      "the spline of {} overshoots by {:.3g}: it is {:.6g} at t = {:.6g} s, between {:.6g} at {:.6g} s and "
      "{:.6g} at {:.6g} s (write \"interpolation\": \"monotone\")",
      where, over.size, over.value, over.x, table->values[over.interval], table->times[over.interval],
      table->values[over.interval + 1], table->times[over.interval + 1]));
}

void warn_of_rate_jumps(const Joint& joint, double end_time, std::vector<std::string>& warnings) {
  const bool turns = joint.type == JointType::revolute;
  for (const MotionFunction::RateJump& jump : MotionFunction(*joint.motion).rate_jumps())
    if (jump.time > 0 && jump.time < end_time)
      warnings.push_back(
          fmt::format("the motion of joint '{}' changes its rate at once, from {:.6g} to {:.6g} {} at t = "
                      "{:.6g} s: the bodies that "
                      "it moves get an impulse (write \"interpolation\": \"monotone\" to start and end at "
                      "rest, or give a "
                      "motion \"of\": \"speed\", which goes on)",
                      joint.name, jump.before, jump.after, turns ? "rad/s" : "m/s", jump.time));
}

}  // namespace

void validate_motion(const Joint& joint, double end_time, const std::string& origin,
                     const std::string& path) {
  if (joint.rate != 0)
    fail(origin, path, "the joint has both a motion and a rate of " + text(joint.rate),
         "leave out the rate: the motion gives it");
  if (const auto* table = std::get_if<TableMotion>(&*joint.motion)) {
    validate_table(*table, FunctionOf::coordinate, origin, path);
    validate_smoothing(*table, origin, path);
    validate_offset(table->of, table->offset, origin, path);
  }
  if (const auto* ramp = std::get_if<RampMotion>(&*joint.motion)) {
    validate_ramp(*ramp, FunctionOf::coordinate, origin, path);
    validate_offset(ramp->of, ramp->offset, origin, path);
  }
  if (joint.limits) validate_travel(joint, end_time, origin, path);
}

void validate_size(const Motion& size, const std::string& origin, const std::string& path) {
  if (const auto* table = std::get_if<TableMotion>(&size))
    validate_table(*table, FunctionOf::force, origin, path);
  if (const auto* ramp = std::get_if<RampMotion>(&size))
    validate_ramp(*ramp, FunctionOf::force, origin, path);
}

std::vector<std::string> warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  if (!scene.mbd) return warnings;
  for (const Joint& joint : scene.mbd->joints) {
    if (!joint.motion) continue;
    warn_of_overshoot(*joint.motion, FunctionOf::coordinate, "joint '" + joint.name + "'", warnings);
    warn_of_rate_jumps(joint, scene.end_time, warnings);
  }
  for (const Force& force : scene.mbd->forces) {
    if (const auto* load = std::get_if<BodyLoad>(&force))
      warn_of_overshoot(load->size, FunctionOf::force, "force '" + load->name + "'", warnings);
    if (const auto* actuator = std::get_if<Actuator>(&force))
      warn_of_overshoot(actuator->size, FunctionOf::force, "actuator '" + actuator->name + "'", warnings);
    if (const auto* motor = std::get_if<Motor>(&force))
      warn_of_overshoot(motor->target, FunctionOf::force, "motor '" + motor->name + "'", warnings);
    if (const auto* cylinder = std::get_if<Cylinder>(&force))
      warn_of_overshoot(cylinder->target, FunctionOf::force, "cylinder '" + cylinder->name + "'", warnings);
    if (const auto* gas = std::get_if<GasSpring>(&force); gas && gas->pressure < gas->ambient_pressure)
      warnings.push_back("gas spring '" + gas->name + "' pulls at the start: its pressure of " +
                         rounded(gas->pressure) + " Pa is below the ambient pressure of " +
                         rounded(gas->ambient_pressure) + " Pa; pressures are absolute, and 1 bar is 1e5 Pa");
  }
  return warnings;
}

}  // namespace tandem::scene
