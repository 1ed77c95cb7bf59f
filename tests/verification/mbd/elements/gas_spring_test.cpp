// Gas springs against closed forms: frequency, adiabatic work, a leak; derivatives against differences.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "mbd_server/forces/gas_spring.hpp"
#include "tests/verification/mbd/machines.hpp"
#include "tests/verification/mbd/whole_run.hpp"

namespace tandem::mbd {
namespace gas_spring_test {

void expect_close(const char* what, double measured, double expected, double tolerance) {
  std::printf("%-52s expected %.12g measured %.12g tolerance %g\n", what, expected, measured, tolerance);
  EXPECT_NEAR(measured, expected, tolerance);
}

// A mass on a level rail, pushed by a spring of 1 m; a constant force balances that of the gas at the start.
struct Rig {
  double mass = 30, rate = 0, balance = 1;
  scene::GasSpring gas;

  Rig() {
    gas.name = "strut", gas.body_a = ground, gas.point_b = {1, 0, 0};
    gas.piston_area = 1e-3, gas.pressure = 2e6, gas.volume = 4e-4, gas.exponent = 1.3;
  }
  double force() const { return (gas.pressure - gas.ambient_pressure) * gas.piston_area; }
  scene::Scene scene() const {
    scene::Scene s = machines::empty({0, 0, 0});
    const BodyId body = machines::add_body(s, "mass", mass, {1, 1, 1}, {1, 0, 0});
    machines::add_joint(s, "rail", scene::JointType::prismatic, ground, body, {1, 0, 0}, {1, 0, 0}).rate =
        rate;
    s.mbd->forces.push_back(gas);
    std::get<scene::GasSpring>(s.mbd->forces.back()).body_b = body;
    s.mbd->forces.push_back(
        scene::Actuator{"load", JointId{0}, scene::ConstantMotion{-balance * force(), 0}});
    return s;
  }
  GasSpring law() const {
    GasSpring law;
    law.area = gas.piston_area, law.volume = gas.volume, law.exponent = gas.exponent;
    law.pressure = gas.pressure, law.ambient = gas.ambient_pressure, law.leakage = gas.leakage;
    return law;
  }
};

// omega^2 = n p A^2 / (V m)
TEST(GasSpring, SmallOscillationsHaveTheFrequencyOfTheGas) {
  for (const double exponent : {1.0, 1.3, 1.667}) {
    Rig rig;
    rig.gas.exponent = exponent, rig.rate = 1e-5;
    const scene::GasSpring& g = rig.gas;
    const double omega =
        std::sqrt(exponent * g.pressure * g.piston_area * g.piston_area / (g.volume * rig.mass));
    const double period = 2 * std::numbers::pi / omega;
    constexpr int steps = 4000;
    machines::Run run(rig.scene(), period / steps, 1, {1e-12, 30});
    run.advance(steps - 10);
    double before = run.state.q[0], crossing = 0;
    for (int i = 0; i < 20 && crossing == 0; ++i) {
      run.advance(1);
      const double now = run.state.q[0];
      if (before < 0 && now >= 0) crossing = run.state.time - run.step * now / (now - before);
      before = now;
    }
    expect_close("period of small oscillations [s]", crossing, period, 1e-6 * period);
  }
}

// The mass has what the gas has done on its way: p_0 V_0 (1 - (V_0/V)^(n-1)) / (n - 1) - p_a A s.
TEST(GasSpring, ExpansionDoesTheAdiabaticWork) {
  Rig rig;
  rig.balance = 0;
  machines::Run run(rig.scene(), 2e-5, 1, {1e-12, 30});
  const double at_start = run.energy();
  run.advance(4000);
  const scene::GasSpring& g = rig.gas;
  const double s = run.state.q[0], V = g.volume + g.piston_area * s, n = g.exponent;
  const double work = g.pressure * g.volume * (1 - std::pow(g.volume / V, n - 1)) / (n - 1) -
                      g.ambient_pressure * g.piston_area * s;
  EXPECT_GT(s, .1);
  expect_close("kinetic energy after the expansion [J]", .5 * rig.mass * run.state.u[0] * run.state.u[0],
               work, 1e-6 * work);
  expect_close("energy of gas and mass [J]", run.energy(), at_start, 1e-6 * work);
}

// Held, isothermal: p - p_a decays with the time V / (L p_0); what was stored is lost.
TEST(GasSpring, ALeakDecaysToThePressureAround) {
  Rig rig;
  rig.gas.exponent = 1, rig.gas.leakage = 1e-9, rig.mass = 1e10, rig.balance = 0;
  const scene::GasSpring& g = rig.gas;
  const double decay = g.volume / (g.leakage * g.pressure), end = 2 * decay;
  double last = 0;
  for (const int steps : {200, 400}) {
    machines::Run run(rig.scene(), end / steps, .8, {1e-12, 30});
    run.advance(steps);
    const double p = g.pressure * run.state.z[0],
                 exact = g.ambient_pressure + (g.pressure - g.ambient_pressure) * std::exp(-2.);
    expect_close("pressure after two decay times [Pa]", p, exact, 1e-4 * exact);
    const double error = std::abs(p - exact);
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 1.8);
    }
    last = error;
  }
  scene::Scene scene = rig.scene();
  scene.coupling.window = .02, scene.end_time = .4, scene.mbd->integrator.step = 1e-3;
  machines::WholeRun run(scene);
  const auto facts = run.facts();
  const GasSpring law = rig.law();
  const auto stored = [&](double p) { return law.stored_energy(0, {p / g.pressure, 0}); };
  const double left = stored(g.ambient_pressure + (g.pressure - g.ambient_pressure) * std::exp(-2.));
  expect_close("energy that has leaked out [J]", facts["mbd_dissipated_J"].get<double>(),
               stored(g.pressure) - left, 1e-4 * stored(g.pressure));
  EXPECT_LT(std::abs(facts["mbd_energy_balance_J"].get<double>()), 1e-4 * stored(g.pressure));
}

// A leak in motion: the residual of the balance falls with the square of the step.
TEST(GasSpring, EnergyBalanceCloses) {
  Rig rig;
  rig.gas.leakage = 2e-9, rig.gas.damping = 200, rig.balance = .8;
  double last = 0;
  for (const double h : {1e-3, 5e-4, 2.5e-4}) {
    scene::Scene scene = rig.scene();
    scene.end_time = .2, scene.coupling.window = .02, scene.mbd->integrator.step = h;
    machines::WholeRun run(scene);
    const auto facts = run.facts();
    const double residual = std::abs(facts["mbd_energy_balance_J"].get<double>()),
                 lost = facts["mbd_dissipated_J"].get<double>();
    std::printf("h = %.1e s: lost %.6f J, residual %.3e J\n", h, lost, residual);
    EXPECT_GT(lost, 1);
    EXPECT_LT(residual, 1e-3 * lost);
    if (last > 0) {
      EXPECT_GT(std::log2(last / residual), 1.6);
    }
    last = residual;
  }
}

// By central differences: the force with its state eliminated; the rates; the energy, whose change is the
// work of the force and what leaks out.
TEST(GasSpring, DerivativesAreThoseOfDifferences) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  double worst = 0;
  const auto compare = [&](double analytic, double plus, double minus, double step) {
    const double difference = (plus - minus) / (2 * step), scale = std::abs(analytic) + std::abs(difference);
    const double error = scale > 0 ? std::abs(analytic - difference) / scale : 0;
    worst = std::max(worst, error);
    EXPECT_LT(error, 2e-6) << analytic << " " << difference;
  };
  const std::string name = "gas spring \"strut\"";
  for (int i = 0; i < 50; ++i) {
    Rig rig;
    rig.gas.exponent = i % 5 == 0 ? 1 : 1 + any(random), rig.gas.leakage = 1e-9 * any(random);
    const GasSpring law = rig.law();
    // At the pressure around it, which it has at about a share of 0.05, the differences lose their digits.
    const double s = .3 * any(random) - .15, share = .3 + .7 * any(random), ds = 1e-6, dz = 1e-6;
    const StatesOfElement z(share, 0), up(share + dz, 0), down(share - dz, 0);
    LawInput in{.name = name, .signal = {}, .known = z, .guess = z, .weight = i % 2 ? .05 * any(random) : 0};
    compare(law.evaluate(in, s, 0).d_s, law.evaluate(in, s + ds, 0).force, law.evaluate(in, s - ds, 0).force,
            ds);
    in.weight = 0;
    const auto at = [&](double stroke, const StatesOfElement& states) {
      LawInput of = in;
      of.known = of.guess = states;
      return law.evaluate(of, stroke, 0);
    };
    const ElementDerivatives d = law.derivatives(in, s, 0, z);
    compare(d.f_z[0], at(s, up).force, at(s, down).force, dz);
    compare(d.g_s[0], at(s + ds, z).zdot[0], at(s - ds, z).zdot[0], ds);
    compare(d.g_z(0, 0), at(s, up).zdot[0], at(s, down).zdot[0], dz);
    compare(-at(s, z).force, law.stored_energy(s + ds, z), law.stored_energy(s - ds, z), ds);
    const double leaving = law.power(in, {s, 0}, z).lost;
    EXPECT_GE(leaving, 0);
    compare(-leaving / at(s, z).zdot[0], law.stored_energy(s, up), law.stored_energy(s, down), dz);
  }
  std::printf("largest difference of a derivative %.2e\n", worst);
}

TEST(GasSpring, AStepThatEmptiesItIsRefused) {
  Rig rig;
  const GasSpring law = rig.law();
  const std::string name = "gas spring \"strut\"";
  const LawInput in{.name = name, .signal = {}};
  try {
    law.evaluate(in, -.5, 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "gas spring \"strut\" has no volume left at a stroke of -0.5 m");
  }
}

// What a user reads about the strut of a lid with these keys more.
std::string refusal(const std::string& keys, const std::string& start = "given") {
  const std::string text =
      R"({"tandem": "1.1", "name": "lid", "end_time": 1, "mbd": {"start": ")" + start +
      R"(", "bodies": [{"name": "lid", "mass": 1, "inertia": [1, 1, 1], "position": [0, 0, 2]}],
          "forces": [{"name": "strut", "type": "gas_spring", "point_a": [0, 0, 0], "point_b": [0, 0, 2],
                      "piston_area": 1e-3, "pressure": 1e6, "volume": 1e-3, )" +
      keys + "}]}}";
  try {
    scene::validate(scene::parse(text, "s"), "s");
  } catch (const Error& error) {
    return error.where() + " " + error.problem();
  }
  return "no error";
}

TEST(GasSpring, WrongKeysAreRefused) {
  const std::string lid = R"("body_b": "lid")";
  EXPECT_EQ(refusal(lid), "no error");
  EXPECT_EQ(refusal(R"("body_b": "ground")"),
            "s: mbd.forces[0].body_b both ends of 'strut' are on the same body");
  EXPECT_EQ(refusal(lid + R"(, "limits": {"lower": -1.5, "upper": 0, "stiffness": 1e6})"),
            "s: mbd.forces[0].limits.lower at a stroke of -1.5 m the gas would have a volume of -0.0005 m3");
  EXPECT_EQ(
      refusal(lid + R"(, "limits": {"lower": 0.1, "upper": 0.2, "stiffness": 1e6})"),
      "s: mbd.forces[0].limits the strokes from 0.1 m to 0.2 m do not contain the stroke at the start, 0");
  EXPECT_EQ(refusal(lid + R"(, "exponent": 0.5)"), "s: mbd.forces[0].exponent the value is 0.5");
  EXPECT_EQ(refusal(lid + R"(, "leakage": 1e-9)", "equilibrium"),
            "s: mbd.forces[0].leakage a gas spring that leaks comes to rest only when its pressure is gone");
}

// As one that was given in bar.
TEST(GasSpring, ThatPullsAtTheStartIsNamed) {
  scene::Scene scene = Rig().scene();
  EXPECT_TRUE(scene::warnings(scene).empty());
  std::get<scene::GasSpring>(scene.mbd->forces[0]).pressure = 77;
  ASSERT_EQ(scene::warnings(scene).size(), 1u);
  EXPECT_NE(scene::warnings(scene)[0].find("its pressure of 77 Pa is below the ambient pressure"),
            std::string::npos);
}

}  // namespace gas_spring_test
}  // namespace tandem::mbd
