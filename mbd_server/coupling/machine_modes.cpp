#include "mbd_server/coupling/machine_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/forces/hydraulics.hpp"
#include "mbd_server/forces/tyre.hpp"
#include "mbd_server/setup/build.hpp"
#include "mbd_server/solve/assembly.hpp"
#include "mbd_server/solve/equilibrium.hpp"
#include "mbd_server/solve/modes.hpp"

namespace tandem::mbd {
namespace {

std::string largest_amplitudes(const std::vector<std::string>& names, const Eigen::VectorXcd& shape,
                               std::size_t most) {
  constexpr double least = 0.05;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(shape.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return std::abs(shape[a]) > std::abs(shape[b]); });
  std::string text;
  for (std::size_t i = 0; i < std::min(most, order.size()); ++i) {
    const std::complex<double> amplitude = shape[order[i]];
    if (std::abs(amplitude) < least) break;
    text += fmt::format("{}{} {:.2f}", i > 0 ? ", " : "", names[static_cast<std::size_t>(order[i])],
                        std::copysign(std::abs(amplitude), amplitude.real()));
  }
  return text;
}

// The coordinates with the largest amplitudes, "hinge 1.00, slider -0.31"; of a mode that does not oscillate
// also the state of first order that changes most, and of one in which nothing moves the states alone.
std::string shape_text(const Model& model, const Mode& mode) {
  if (mode.shape.isZero(0)) return largest_amplitudes(model.state_names, mode.states, 3);
  std::string text = largest_amplitudes(model.coordinate_names, mode.shape, 3);
  if (mode.s.imag() != 0 || mode.states.size() == 0) return text;
  Eigen::Index most = 0;
  mode.states.cwiseAbs().maxCoeff(&most);
  return text + "; " + model.state_names[static_cast<std::size_t>(most)];
}

std::string kind(const Mode& mode) {
  if (mode.s.imag() == 0)
    return mode.s.real() > 0 ? fmt::format("grows, time constant {:.4g} s", 1 / mode.s.real())
                             : fmt::format("decays, time constant {:.4g} s", -1 / mode.s.real());
  const double ratio = mode.damping_ratio();
  return fmt::format("{:.6g} Hz, damping ratio {:.4g}{}", mode.frequency(),
                     std::abs(ratio) < 1e-9 ? 0 : ratio, ratio < -1e-9 ? " (grows)" : "");
}

std::string meaning(const scene::Scene& scene, const Modes& found) {
  const auto swings = [](const Mode& m) { return m.s.imag() != 0; };
  const auto fastest = std::find_if(found.modes.rbegin(), found.modes.rend(), swings);
  std::string decays;
  if (const auto decaying = std::find_if(found.modes.rbegin(), found.modes.rend(),
                                         [](const Mode& m) { return m.s.imag() == 0 && m.s.real() < 0; });
      decaying != found.modes.rend() && !found.modes.front().states.isZero(0))
    decays = fmt::format(
        "The fastest decay has a time constant of {:.4g} s. A step or a window that is longer than a time "
        "constant sees only what is left after it: pressures and controllers follow at once.\n",
        -1 / decaying->s.real());
  if (fastest == found.modes.rend()) return "No mode oscillates.\n" + decays;
  const double period = 2 * std::numbers::pi / fastest->s.imag(), window = scene.coupling.window;
  const double step = scene.mbd->integrator.step.value_or(window);
  std::string text = fmt::format("The fastest oscillation has a period of {:.4g} s: ", period);
  if (!scene.mbd->integrator.error_tolerance)
    text += fmt::format(
        "{:.3g} steps of the integrator ({:.4g} s), of which 20 resolve it to about 1 %; "
        "with fewer it is damped numerically.",
        period / step, step);
  if (scene.has_particles())
    text += fmt::format(
        " A window of {:.4g} s is {:.3g} of it; modes of bodies that the particles touch want "
        "windows of a twentieth of their period at most.",
        window, window / period);
  return text + "\n" + decays;
}

// The machine is at rest in its equilibrium, whatever the scene says of its rates.
std::string rates_left_out(const scene::Scene& scene, const State& state) {
  if (state.u.isZero(0)) return {};
  std::string of;
  for (const scene::Joint& joint : scene.mbd->joints)
    if (of.empty() && joint.rate != 0)
      of = ", such as " + fmt::format("{:.6g}", joint.rate) + " at joint '" + joint.name + "'";
  return "The rates of the scene are left out" + of +
         ": a rotor that spins has other modes. Take them with --as-given, if the machine keeps its rates.\n";
}

// Friction is left out in an equilibrium; a joint that sticks would take part in no mode.
std::string stiction_left_out(const scene::Scene& scene) {
  std::string names;
  const auto add = [&](const std::string& name) {
    names += (names.empty() ? "" : ", ") + ("'" + name + "'");
  };
  for (const scene::Joint& joint : scene.mbd->joints)
    if (joint.friction && joint.friction->breakaway) add(joint.name);
  for (const scene::Force& force : scene.mbd->forces)
    if (const auto* motor = std::get_if<scene::Motor>(&force);
        motor && motor->brake && motor->brake->breakaway)
      add(motor->name);
  if (names.empty()) return {};
  return "Stiction of " + names +
         " is left out: the modes are those of joints that are free to slide. For those of joints that "
         "stick, make "
         "them fixed.\n";
}

}  // namespace

std::string machine_modes(const scene::Scene& scene, bool as_given) {
  const Model model = build_model(scene);
  MachineSystem system(model);
  if (scene.contact)
    throw Error(ErrorCode::scene, "modes know no contacts between bodies", "mbd.contact",
                "leave it out, and give bushings or springs where bodies rest on each other");
  if (!forces_of<TyreOnLink>(model).empty())
    throw Error(ErrorCode::scene, "modes know no tyres", "mbd.forces",
                "leave them out, and give bushings or springs where the wheels stand on the road");
  State state = initial_state(model, scene);
  assemble(scene, model, system, state);
  std::string text;
  if (as_given) {
    system.residual(state);
    text = "Modes about the configuration of the scene\n";
  } else {
    const std::string spinning = rates_left_out(scene, state);
    state.u.setZero();
    const EquilibriumReport found = find_equilibrium(model, system, state);
    text = "Modes about the equilibrium near the configuration of the scene\n" + spinning;
    if (found.distance > 1e-9)
      text += fmt::format("largest change of a coordinate: {:.4g} rad or sizes of the machine, at {}\n",
                          found.distance, found.moved);
    if (found.state_change > 1e-6)
      text += fmt::format("largest change of a state, relative to its scale: {:.4g}, at the {}\n",
                          found.state_change, found.changed_state);
  }
  text += stiction_left_out(scene);
  for (const Element* e : forces_of<Element>(model))
    if (const auto* oil = e->law_as<Hydraulics>()) {
      const double lowest = std::min(state.z[e->state], state.z[e->state + 1]);
      if (lowest < oil->cavitation)
        text += fmt::format(
            "{} cavitates there: its oil would have a pressure of {:.3g} Pa; give it more pressure_a and "
            "pressure_b\n",
            e->name, lowest);
    }
  const Modes found = find_modes(model, system, state);
  if (found.neutral > 0)
    text += fmt::format("{} independent coordinate{} free to move: nothing holds {}\n", found.neutral,
                        found.neutral == 1 ? " is" : "s are", found.neutral == 1 ? "it" : "them");
  if (found.constants > 0)
    text += fmt::format(
        "{} quantit{} constant, as the mass of oil behind a closed valve, or the angle that an "
        "integral of the speed holds\n",
        found.constants, found.constants == 1 ? "y is" : "ies are");
  int number = 0;
  for (const Mode& mode : found.modes)
    text += fmt::format("{:>4}  {:<46}  {}\n", ++number, kind(mode), shape_text(model, mode));
  return text + meaning(scene, found);
}

}  // namespace tandem::mbd
