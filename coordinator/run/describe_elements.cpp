#include "coordinator/run/describe_elements.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/overloaded.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/motion_function.hpp"

namespace tandem::launch {
namespace {

using namespace scene;

using Parts = std::vector<std::string>;

std::string input_or_start(const Motion& motion, const std::string& input, const char* unit) {
  if (!input.empty()) return "input " + input;
  return fmt::format("{:.4g}{} at the start", MotionFunction(motion, FunctionOf::force).at(0, 0).value, unit);
}

Parts figures(const SpringDamper& f) {
  const double length = norm(f.point_b - f.point_a);
  Parts parts{fmt::format("{:.6g} m long at the start, {:.6g} m unloaded", length, f.length)};
  if (f.table)
    parts.push_back("force by a table");
  else
    parts.push_back(fmt::format("pulls with {:.6g} N", f.stiffness * (length - f.length)));
  return parts;
}

Parts figures(const RotationalSpringDamper& f) {
  if (f.table) return {"torque by a table"};
  return {fmt::format("gives {:.6g} N m at the start", f.stiffness * f.angle)};
}

Parts figures(const Rope& f) {
  double way = 0;
  for (std::size_t i = 1; i < f.points.size(); ++i) way += norm(f.points[i].point - f.points[i - 1].point);
  const double stretch = way - f.length;
  return {fmt::format("{:.6g} m long, its way at the start {:.6g} m", f.length, way),
          stretch > 0 ? fmt::format("tension {:.6g} N", f.axial_stiffness / f.length * stretch)
                      : fmt::format("slack by {:.6g} m", -stretch)};
}

Parts figures(const BodyLoad& f) {
  if (f.over) return {"size over a joint coordinate"};
  return {input_or_start(f.size, "", f.kind == BodyLoad::Kind::force ? " N" : " N m")};
}

Parts figures(const Actuator& f, bool rotates) {
  if (f.over) return {"size over a joint coordinate"};
  return {input_or_start(f.size, f.input, rotates ? " N m" : " N")};
}

Parts figures(const Motor& f) {
  static constexpr const char *words[] = {"speed", "position", "throttle"}, *units[] = {" rad/s", " rad", ""};
  const auto control = static_cast<std::size_t>(f.control);
  Parts parts{fmt::format("control of the {}, {}", words[control],
                          input_or_start(f.target, f.input, units[control]))};
  if (f.torque_speed) {
    const auto& speeds = f.torque_speed->arguments;
    const auto& torques = f.torque_speed->values;
    const auto [least, most] = std::ranges::minmax_element(torques);
    parts.push_back(fmt::format("shaft {:.4g} to {:.4g} N m from {:.4g} to {:.4g} rad/s", *least, *most,
                                speeds.front(), speeds.back()));
  }
  if (f.max_torque)
    parts.push_back(fmt::format("at most {:.4g} N m at the joint", f.gear_ratio * *f.max_torque));
  if (f.gear_ratio != 1) parts.push_back(fmt::format("gear {:.4g}", f.gear_ratio));
  if (f.rotor_inertia > 0)
    parts.push_back(
        fmt::format("rotor {:.4g} kg m2 at the joint", f.gear_ratio * f.gear_ratio * f.rotor_inertia));
  if (f.brake) parts.push_back(fmt::format("brake {:.4g} N m", f.brake->torque));
  return parts;
}

// Speeds are those of a fully open valve without a load: both edges let A v = K sqrt(dp) pass, and the forces
// of the chambers are equal.
void add_hydraulics(const Cylinder& f, Parts& parts) {
  const HydraulicData& oil = *f.hydraulics;
  const double a = oil.bore_area, b = oil.bore_area - oil.rod_area, ps = oil.supply_pressure,
               pt = oil.tank_pressure, K = oil.valve_flow / std::sqrt(oil.valve_drop);
  const auto speed = [&](double fed, double emptied) {
    const double drive = std::max(0.0, fed * ps - emptied * pt);
    const double v = K * std::sqrt(drive / (fed * fed * fed + emptied * emptied * emptied));
    return oil.pump_flow ? std::min(v, *oil.pump_flow / fed) : v;
  };
  parts.push_back(fmt::format("areas {:.6g} m2 (a) and {:.6g} m2 (b)", a, b));
  parts.push_back(
      fmt::format("pressures {:.4g} Pa (supply), {:.4g} Pa (tank), {:.4g} and {:.4g} Pa in a and b "
                  "at the start",
                  ps, pt, oil.pressure_a.value_or(pt), oil.pressure_b.value_or(pt)));
  parts.push_back(
      fmt::format("pushes up to {:.4g} N, pulls up to {:.4g} N", ps * a - pt * b, ps * b - pt * a));
  parts.push_back(
      fmt::format("without load up to {:.3g} m/s out and {:.3g} m/s in", speed(a, b), speed(b, a)));
  if (!f.limits) return;
  const double va = oil.dead_volume - a * f.limits->lower, vb = oil.dead_volume + b * f.limits->upper;
  parts.push_back(fmt::format("force at the start {:.4g} N, oil as stiff as {:.3g} N/m",
                              oil.pressure_a.value_or(pt) * a - oil.pressure_b.value_or(pt) * b,
                              oil.bulk_modulus * (a * a / va + b * b / vb)));
}

Parts figures(const Cylinder& f) {
  static constexpr const char *words[] = {"stroke", "force", "valve"}, *units[] = {" m", " N", ""};
  const auto control = static_cast<std::size_t>(f.control);
  Parts parts{
      fmt::format("control of the {}, {}", words[control], input_or_start(f.target, f.input, units[control])),
      fmt::format("{:.6g} m long at the start", norm(f.point_b - f.point_a))};
  if (f.limits) parts.push_back(fmt::format("stroke {:.4g} to {:.4g} m", f.limits->lower, f.limits->upper));
  if (f.max_force) parts.push_back(fmt::format("at most {:.4g} N", *f.max_force));
  if (f.hydraulics) add_hydraulics(f, parts);
  return parts;
}

Parts figures(const Tyre& f, const Mbd& mbd) {
  if (!f.road.empty())
    return {fmt::format("radius {:.6g} m", f.radius), fmt::format("on {}", fmt::join(f.road, ", "))};
  const double height = dot(mbd.joints[f.joint.value].position - f.road_point, f.road_normal),
               deflection = f.radius - height;
  return {fmt::format("{:.6g} m above the road at the start, radius {:.6g} m", height, f.radius),
          deflection > 0 ? fmt::format("bears {:.6g} N there", f.stiffness * deflection)
                         : std::string("does not touch the road there")};
}

Parts figures(const Force& force, const Mbd& mbd) {
  return std::visit(Overloaded{[&](const Actuator& f) {
                                 return figures(f, mbd.joints[f.joint.value].type != JointType::prismatic);
                               },
                               [&](const Tyre& f) { return figures(f, mbd); },
                               [](const Bushing&) { return Parts{"unloaded at the start"}; },
                               [](const auto& f) {
                                 if constexpr (requires { f.figures(); })
                                   return f.figures();
                                 else
                                   return figures(f);
                               }},
                    force);
}

}  // namespace

std::string describe_elements(const Scene& scene) {
  std::string out;
  for (const ElementOfScene& element : elements_of(scene)) {
    if (element.source != ElementOfScene::Source::force) continue;
    if (out.empty()) out = "\nelements\n";
    out += fmt::format("  {}: {}\n", element.name,
                       fmt::join(figures(scene.mbd->forces[element.index], *scene.mbd), "; "));
  }
  return out;
}

}  // namespace tandem::launch
