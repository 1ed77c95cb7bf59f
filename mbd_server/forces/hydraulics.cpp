#include "mbd_server/forces/hydraulics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

struct Flow {
  double value = 0, slope = 0;  // per pressure drop
};

Flow orifice(const Hydraulics& law, double opening, double drop) {
  const double d2 = law.laminar * law.laminar, sum = drop * drop + d2;
  const double K = opening * law.flow / law.drop * std::pow(law.drop * law.drop + d2, 0.25);
  const double root = std::pow(sum, -0.25);
  return {K * drop * root, K * root * (0.5 * drop * drop + d2) / sum};
}

// Flow into a chamber at pressure p, from the supply or from the tank, with its slope in p.
Flow from_supply(const Hydraulics& law, double opening, double p) {
  const Flow q = orifice(law, opening, law.supply - p);
  return q.value > law.pump ? Flow{law.pump, 0} : Flow{q.value, -q.slope};
}
Flow from_tank(const Hydraulics& law, double opening, double p) {
  const Flow q = orifice(law, opening, law.tank - p);
  return {q.value, -q.slope};
}

struct Ports {
  Flow a, b;
};
Ports ports(const Hydraulics& law, double opening, const StatesOfElement& p) {
  if (opening >= 0) return {from_supply(law, opening, p[0]), from_tank(law, opening, p[1])};
  return {from_tank(law, -opening, p[0]), from_supply(law, -opening, p[1])};
}

struct Volumes {
  double a, b;
};
Volumes volumes(const Hydraulics& law, double s) {
  return {law.volume + law.area_a * (s - law.lower), law.volume + law.area_b * (law.upper - s)};
}

// Rates of the pressures and their derivatives with respect to them.
struct Rates {
  StatesOfElement g;
  Eigen::Matrix2d g_p;
};
Rates rates(const Hydraulics& law, const Ports& at, const Volumes& V, double v, const StatesOfElement& p) {
  const double leak = law.leakage * (p[0] - p[1]), ka = law.modulus / V.a, kb = law.modulus / V.b;
  Rates r;
  r.g << ka * (at.a.value - leak - law.area_a * v), kb * (at.b.value + leak + law.area_b * v);
  r.g_p << ka * (at.a.slope - law.leakage), ka * law.leakage, kb * law.leakage,
      kb * (at.b.slope - law.leakage);
  return r;
}

// Energy that a volume of oil carries per its size: p + B (e^x - 1 - x) [Pa].
double carried(const Hydraulics& law, double p) {
  return law.modulus * std::expm1(p / law.modulus);
}

// Before the start the machine also moves where it cannot be in a run.
void expect_oil(const Volumes& V, const std::string& name, double s) {
  if (!(V.a > 0 && V.b > 0))
    throw Error(
        ErrorCode::numerics,
        fmt::format("{} has no oil left in chamber {} at a stroke of {:.6g} m", name, V.a > 0 ? "b" : "a", s),
        "mbd_server", "give its limits more stiffness, or the chambers a larger dead_volume");
}

// Of the force per pressure, and of the rates of the pressures per stroke and per its rate.
Eigen::RowVector2d areas(const Hydraulics& law) {
  return {law.area_a, -law.area_b};
}
StatesOfElement per_stroke(const Hydraulics& law, const Volumes& V, const StatesOfElement& g) {
  return {-g[0] * law.area_a / V.a, g[1] * law.area_b / V.b};
}
StatesOfElement per_speed(const Hydraulics& law, const Volumes& V) {
  return {-law.modulus / V.a * law.area_a, law.modulus / V.b * law.area_b};
}

}  // namespace

// The equation of the pressures is the gradient of a convex function, since no flow into a chamber grows with
// its pressure: Newton's method with a line search converges from anywhere.
ElementValue Hydraulics::evaluate(const LawInput& in, double s, double v) const {
  const Hydraulics& law = *this;
  const std::string& name = in.name;
  const StatesOfElement &known = in.known, &guess = in.guess;
  const double opening = in.signal.value, weight = in.weight;
  const Volumes V = volumes(law, s);
  if (weight > 0) expect_oil(V, name, s);
  ElementValue out;
  StatesOfElement p = weight > 0 ? guess : known;
  Rates r;
  Eigen::Matrix2d J = Eigen::Matrix2d::Identity();
  if (weight > 0) {
    constexpr int most = 100;
    const double scale = std::abs(law.supply) + std::abs(law.tank);
    const Eigen::Array2d metric(V.a / law.modulus, V.b / law.modulus);
    const auto defect = [&](const StatesOfElement& at) {
      r = rates(law, ports(law, opening, at), V, v, at);
      return StatesOfElement(at - known - weight * r.g);
    };
    const auto size = [&](const StatesOfElement& F) { return (F.array().square() * metric).sum(); };
    StatesOfElement F = defect(p);
    for (int i = 0;; ++i) {
      J = Eigen::Matrix2d::Identity() - weight * r.g_p;
      const StatesOfElement step = J.inverse() * F;
      const double before = size(F);
      const StatesOfElement begin = p;
      double share = 1;
      for (;; share /= 2) {
        p = begin - share * step;
        F = defect(p);
        if (size(F) <= (1 - 1e-4 * share) * before || share < 1e-6) break;
      }
      if (step.cwiseAbs().maxCoeff() <= 1e-12 * (scale + p.cwiseAbs().maxCoeff())) break;
      if (i == most || !std::isfinite(before))
        throw Error(ErrorCode::numerics, fmt::format("the pressures of {} have no solution", name),
                    "mbd_server", "check areas, volumes, flows and pressures of its hydraulics");
    }
  }
  const Ports at = ports(law, opening, p);
  r = rates(law, at, V, v, p);
  J = Eigen::Matrix2d::Identity() - weight * r.g_p;
  const Eigen::RowVector2d f_J = weight * areas(law) * J.inverse();
  out.force = areas(law) * p;
  out.d_s = f_J * per_stroke(law, V, r.g);
  out.d_v = f_J * per_speed(law, V);
  out.z = p;
  out.zdot = r.g;
  return out;
}

StatesOfElement Hydraulics::kept_at_rest(double s, const StatesOfElement& p) const {
  const Volumes V = volumes(*this, s);
  return {p[0] + modulus * std::log(V.a / volume), p[1] + modulus * std::log(V.b / volume)};
}

// Behind a closed valve V e^(p/B) is constant in each chamber. Leakage exchanges equal volumes and makes both
// pressures equal; the sum of both masses is constant up to the compressibility p/B of the volumes exchanged.
ElementValue Hydraulics::at_rest(const LawInput& in, double s) const {
  const Hydraulics& law = *this;
  const double opening = in.signal.value;
  const StatesOfElement& kept = in.known;
  constexpr double long_time = 1e12;  // [s]
  const Volumes V = volumes(law, s);
  expect_oil(V, in.name, s);
  ElementValue out;
  if (opening != 0) {
    LawInput settled = in;
    settled.known = in.guess, settled.weight = long_time;
    out = evaluate(settled, s, 0);
    out.d_s = out.d_v = 0;
    out.zdot.setZero();
    return out;
  }
  const double B = law.modulus;
  if (law.leakage > 0) {
    const double both = V.a + V.b, most = std::max(kept[0], kept[1]);
    const double p = most + B * std::log(law.volume / both *
                                         (std::exp((kept[0] - most) / B) + std::exp((kept[1] - most) / B)));
    out.z << p, p;
    out.d_s = -B * (law.area_a - law.area_b) * (law.area_a - law.area_b) / both;
  } else {
    out.z << kept[0] - B * std::log(V.a / law.volume), kept[1] - B * std::log(V.b / law.volume);
    out.d_s = -B * (law.area_a * law.area_a / V.a + law.area_b * law.area_b / V.b);
  }
  out.force = areas(law) * out.z;
  return out;
}

ElementDerivatives Hydraulics::derivatives(const LawInput& in, double s, double v,
                                           const StatesOfElement& p) const {
  const Hydraulics& law = *this;
  const double opening = in.signal.value;
  const Volumes V = volumes(law, s);
  const Rates r = rates(law, ports(law, opening, p), V, v, p);
  ElementDerivatives d;
  d.f_z = areas(law);
  d.g_s = per_stroke(law, V, r.g);
  d.g_v = per_speed(law, V);
  d.g_z = r.g_p;
  if (opening == 0) d.constants = law.leakage > 0 ? 1 : 2;
  return d;
}

ChamberFlows valve_flows(const Hydraulics& law, double opening, const StatesOfElement& p) {
  const Ports at = ports(law, opening, p);
  return {at.a.value, at.b.value};
}

// Energy enters the chambers with their flows. Of what the supply gives, the edge dissipates the part between
// the pressure of the supply and that of the chamber; a pump at its limit works at the pressure that it has.
ElementPower Hydraulics::power(const LawInput& in, ElementArgument, const StatesOfElement& p) const {
  const Hydraulics& law = *this;
  const double opening = in.signal.value;
  const Ports at = ports(law, opening, p);
  const bool extends = opening >= 0;
  const double fed = extends ? at.a.value : at.b.value, emptied = extends ? at.b.value : at.a.value;
  const double p_fed = extends ? p[0] : p[1], p_emptied = extends ? p[1] : p[0];
  double feeding = law.supply;
  if (fed >= law.pump) {
    // The drop at which the edge lets this flow pass.
    double low = 0, high = std::max(0.0, law.supply - p_fed);
    for (int i = 0; i < 60; ++i) {
      const double middle_drop = (low + high) / 2;
      (orifice(law, std::abs(opening), middle_drop).value < fed ? low : high) = middle_drop;
    }
    feeding = p_fed + high;
  }
  const double leak = law.leakage * (p[0] - p[1]);
  const double entering = fed * carried(law, feeding), leaving = -emptied * carried(law, law.tank);
  return {entering - leaving, entering - fed * carried(law, p_fed) - emptied * carried(law, p_emptied) -
                                  leaving + leak * (carried(law, p[0]) - carried(law, p[1]))};
}

double Hydraulics::stored_energy(double s, const StatesOfElement& p) const {
  const Hydraulics& law = *this;
  const Volumes V = volumes(law, s);
  const auto of = [&](double in_chamber, double pressure) {
    const double x = pressure / law.modulus;
    // Below, the difference loses its digits.
    const double density = std::abs(x) < 1e-3 ? x * x * (0.5 + x * (1. / 6 + x / 24)) : std::expm1(x) - x;
    return in_chamber * law.modulus * density;
  };
  return of(V.a, p[0]) + of(V.b, p[1]);
}

void Hydraulics::observe(int account, const LawInput& in, ElementArgument x, const StatesOfElement& p,
                         ChannelValues& to) const {
  using scene::Channel;
  to.add(account, Channel::supply_power, power(in, x, p).work);
  to.add(account, Channel::pressure_a, p[0]);
  to.add(account, Channel::pressure_b, p[1]);
  const ChamberFlows flows = valve_flows(*this, in.signal.value, p);
  to.add(account, Channel::flow_a, flows.a);
  to.add(account, Channel::flow_b, flows.b);
}

}  // namespace tandem::mbd
