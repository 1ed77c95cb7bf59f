#include "mbd_server/forces/gas_spring.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/error.hpp"

namespace tandem::mbd {
namespace gas_spring {

double volume_at(const GasSpring& law, double s) {
  return law.volume + law.area * s;
}

double share_of(const GasSpring& law, const StatesOfElement& z) {
  return law.leakage > 0 ? z[0] : 1;
}

double pressure_of(const GasSpring& law, double share, double V) {
  return law.pressure * std::pow(share * law.volume / V, law.exponent);
}

// Of the share that is left, and its derivative by the share.
double leak_rate(const GasSpring& law, double p) {
  return -law.leakage * (p - law.ambient) / law.volume;
}
double leak_slope(const GasSpring& law, double p, double share) {
  return -law.leakage * law.exponent * p / (share * law.volume);
}

// The root of mu = known + weight mu'(mu): mu - weight mu' grows and is convex, so that Newton's method comes
// to the root from above after its first iteration.
double solved_share(const GasSpring& law, const LawInput& in, double V) {
  constexpr int most = 100;
  double share = in.guess[0] > 0 ? in.guess[0] : 1;
  for (int i = 0; i < most; ++i) {
    const double p = pressure_of(law, share, V);
    const double defect = share - in.known[0] - in.weight * leak_rate(law, p);
    const double change = defect / (1 - in.weight * leak_slope(law, p, share));
    share -= change;
    if (!(share > 0)) break;
    if (std::abs(change) <= 1e-15 * share) return share;
    if (i > 2 && std::abs(change) <= 4e-15 * share) return share;
  }
  throw Error(ErrorCode::numerics, fmt::format("the leak of {} empties it within one step", in.name),
              "mbd_server", "give mbd.integrator a shorter step, or the gas spring less leakage");
}

// Work of the gas of this share on its way to the volume V_e at which it has the pressure around it: the
// integral of p dV from V to V_e = r V is p_a V r (r^(n-1) - 1) / (n - 1).
struct ToAmbient {
  double ratio, work;  // r [-], [J]
};
ToAmbient to_ambient(const GasSpring& law, double share, double V) {
  const double r = share * law.volume / V * std::pow(law.pressure / law.ambient, 1 / law.exponent);
  const double k = law.exponent - 1, log = std::log(r);
  return {r, law.ambient * V * r * (k == 0 ? log : std::expm1(k * log) / k)};
}

}  // namespace gas_spring

using namespace gas_spring;

double GasSpring::pressure_at(double s, const StatesOfElement& z) const {
  return pressure_of(*this, share_of(*this, z), volume_at(*this, s));
}

ElementValue GasSpring::evaluate(const LawInput& in, double s, double) const {
  const double V = volume_at(*this, s);
  if (!(V > 0))
    throw Error(ErrorCode::numerics, fmt::format("{} has no volume left at a stroke of {:.6g} m", in.name, s),
                "mbd_server", "give it limits with more stiffness, or more volume");
  ElementValue out;
  double share = share_of(*this, in.known);
  if (leakage > 0 && in.weight > 0) share = solved_share(*this, in, V);
  const double p = pressure_of(*this, share, V), by_stroke = -exponent * p * area / V;
  out.force = area * (p - ambient);
  out.d_s = area * by_stroke;
  if (leakage == 0) return out;
  out.z[0] = share, out.zdot[0] = leak_rate(*this, p);
  const double share_by_stroke =
      -in.weight * leakage / volume * by_stroke / (1 - in.weight * leak_slope(*this, p, share));
  out.d_s += area * exponent * p / share * share_by_stroke;
  return out;
}

ElementDerivatives GasSpring::derivatives(const LawInput&, double s, double, const StatesOfElement& z) const {
  ElementDerivatives d;
  if (leakage == 0) return d;
  const double V = volume_at(*this, s), share = share_of(*this, z), p = pressure_of(*this, share, V);
  d.f_z[0] = area * exponent * p / share;
  d.g_s[0] = leakage / volume * exponent * p * area / V;
  d.g_z(0, 0) = leak_slope(*this, p, share);
  return d;
}

void GasSpring::expect_rest(const LawInput& in) const {
  if (leakage > 0)
    throw Error(ErrorCode::scene, in.name + " leaks, so that it comes to rest only when its pressure is gone",
                "mbd.forces", "leave out its leakage");
}

// Gas that leaves takes its part of the energy with it.
ElementPower GasSpring::power(const LawInput&, ElementArgument x, const StatesOfElement& z) const {
  if (leakage == 0) return {};
  const double V = volume_at(*this, x.s), share = share_of(*this, z), p = pressure_of(*this, share, V);
  return {.lost = -leak_rate(*this, p) / share * exponent * to_ambient(*this, share, V).work};
}

// Work that the gas can do against the pressure around it [J].
double GasSpring::stored_energy(double s, const StatesOfElement& z) const {
  const double V = volume_at(*this, s);
  const ToAmbient way = to_ambient(*this, share_of(*this, z), V);
  return way.work - ambient * V * (way.ratio - 1);
}

void GasSpring::observe(int account, const LawInput&, ElementArgument x, const StatesOfElement& z,
                        ChannelValues& to) const {
  to.add(account, scene::Channel::pressure, pressure_at(x.s, z));
}

}  // namespace tandem::mbd
