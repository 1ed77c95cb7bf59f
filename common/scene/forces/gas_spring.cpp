#include <fmt/format.h>

#include "common/scene/element_columns.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/parse_parts.hpp"

namespace tandem::scene {

GasSpring GasSpring::read(const Node& node, const Names& bodies, const Names&) {
  GasSpring gas;
  node.read("name", gas.name);
  gas.body_a = read_body(node, "body_a", bodies);
  gas.body_b = read_body(node, "body_b", bodies);
  read_keys(node, gas);
  if (node.has("limits")) gas.limits = parse_limits(node.at("limits"));
  return gas;
}

void GasSpring::validate(const Mbd& mbd, const std::string& origin, const std::string& path) const {
  if (body_a == body_b)
    fail(origin, path + ".body_b", "both ends of '" + name + "' are on the same body",
         "a gas spring acts between two bodies, or a body and the ground");
  if (point_a == point_b)
    fail(origin, path + ".point_b", "both ends are at " + text(point_b) + ": the force has no direction",
         "move one of the points");
  if (leakage > 0 && mbd.start == Start::equilibrium)
    fail(origin, path + ".leakage", "a gas spring that leaks comes to rest only when its pressure is gone",
         "leave out leakage, or leave out mbd.start");
  if (!limits) return;
  if (!(limits->lower <= 0 && 0 <= limits->upper && limits->lower < limits->upper))
    fail(origin, path + ".limits",
         "the strokes from " + text(limits->lower) + " m to " + text(limits->upper) +
             " m do not contain the stroke at the start, 0",
         "strokes are counted from the length at the start: lower <= 0 <= upper");
  if (limits->restitution)
    fail(origin, path + ".limits.restitution", "the end stops of a gas spring have a damping",
         "give damping, or limits with a restitution at a prismatic joint");
  if (const double left = volume + piston_area * limits->lower; !(left > 0))
    fail(origin, path + ".limits.lower",
         "at a stroke of " + text(limits->lower) + " m the gas would have a volume of " + rounded(left) +
             " m3",
         "give more than " + rounded(-volume / piston_area) + " m, or a larger volume");
}

std::vector<Channel> GasSpring::channels() const {
  std::vector<Channel> list{Channel::force,  Channel::stroke,   Channel::velocity,     Channel::power,
                            Channel::energy, Channel::pressure, Channel::stored_energy};
  if (leakage > 0 || damping != 0 || limits)
    list.insert(list.end(), {Channel::loss_power, Channel::loss_energy});
  return list;
}

std::vector<std::string> GasSpring::figures() const {
  const double stiffness = exponent * pressure * piston_area * piston_area / volume;
  return {fmt::format("{:.6g} m long at the start", norm(point_b - point_a)),
          fmt::format("pushes with {:.6g} N there, as stiff as {:.4g} N/m",
                      (pressure - ambient_pressure) * piston_area, stiffness)};
}

}  // namespace tandem::scene
