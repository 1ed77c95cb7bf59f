#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/verdict/figures.hpp"
#include "coordinator/verdict/rules.hpp"

namespace tandem::launch {
namespace {

double length_of(const Json& vector) {
  return std::hypot(vector[0].get<double>(), vector[1].get<double>(), vector[2].get<double>());
}

// |a - b - c| of three vectors.
double open_part(const Json& a, const Json& b, const Json& c) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double open = a[i].get<double>() - b[i].get<double>() - c[i].get<double>();
    sum += open * open;
  }
  return std::sqrt(sum);
}

// What to write instead: a window, and scheme `implicit` where the scene has another.
std::string shorter_window(const scene::Coupling& coupling, double window) {
  return fmt::format("use coupling.window = {:.2g} s (now {:.2g}){}", window, coupling.window,
                     coupling.scheme == scene::Scheme::implicit ? "" : ", or coupling.scheme = \"implicit\"");
}

}  // namespace

void add_coupling_rules(std::vector<Rule>& table) {
  table.push_back(
      {"energy_coupling", "abs(energy_residual)", 0.05,
       "energy that the coupling creates or removes, relative to the energy that bodies and particles "
       "exchange; runs of the stability gallery whose motion was right stay below 0.02, those that were "
       "wrong lie above 0.1",
       "a shorter window, or scheme `implicit`", nullptr,
       [](const RunFigures& run) -> Figures {
         const auto residual = run.number("energy_residual");
         return residual ? of_run(std::abs(*residual)) : std::nullopt;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the coupling {} {:.2g} of the energy that bodies and particles exchange (limit {:.2g}): {}",
             run.number("energy_residual").value_or(0) > 0 ? "made" : "took away", f.value, limit,
             shorter_window(run.scene.coupling,
                            std::max(0.1, 0.9 * std::sqrt(limit / f.value)) * run.scene.coupling.window));
       }});
  table.push_back(
      {"impulse_closure", "impulse_closure", 1e-9,
       "the impulse that particles give and the one that bodies receive are equal up to rounding, which "
       "reaches 1e-12 in a million windows",
       "a participant that applies all of the load", nullptr,
       [](const RunFigures& run) { return of_run(run.number("impulse_closure")); },
       [](const RunFigures& run, const Figure& f, double limit) {
         std::string who = "a body", what = "load";
         double worst = 0, given = 0, got = 0;
         const auto interface = run.summary.find("border");
         if (interface != run.summary.end())
           for (const auto& [name, body] : interface->items())
             for (const char* part : {"", "angular_"}) {
               const std::string key = std::string(part) + "impulse_";
               const Json &recorded = body.at(key + "booked"), &applied = body.at(key + "applied");
               const double open = open_part(recorded, applied, body.at(key + "outstanding")),
                            whole = length_of(recorded);
               if (!(open / std::max(whole, 1e-300) > worst)) continue;
               worst = open / std::max(whole, 1e-300), given = whole, got = length_of(applied);
               who = "body '" + name + "'", what = *part ? "N m s of torque" : "N s of force";
             }
         return fmt::format(
             "of {:.4g} {} that the particles gave {} it was moved by {:.4g}; impulse_closure is "
             "{:.2g} (limit {:.0e}): use a multibody participant that applies force and torque of "
             "every load, as mbd_server of this version does (docs/protocol.md)",
             given, what, who, got, f.value, limit);
       }});
  table.push_back({"impulse_outstanding", "impulse_outstanding", 0.1,
                   "share of the particles' load that a scheme withholds to stay stable; a body that "
                   "receives less than nine tenths of its load moves differently",
                   "a shorter window, or scheme `implicit`", nullptr,
                   [](const RunFigures& run) { return of_run(run.number("impulse_outstanding")); },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     return fmt::format(
                         "{:.2g} of the particles' load has not reached the bodies (limit {:.2g}): {}",
                         f.value, limit,
                         shorter_window(run.scene.coupling,
                                        std::max(0.1, 0.9 * limit / f.value) * run.scene.coupling.window));
                   }});
  table.push_back(
      {"window_stability", "border.BODY.omega_H / border.BODY.stable_omega_H", 2,
       "the estimate of omega H treats the grains as fixed and is an upper bound: a bed as heavy as the body "
       "or lighter lowers the true value by up to a factor of two; beyond that the motion grows",
       "the largest stable window, or a scheme that is stable with this one", nullptr,
       [](const RunFigures& run) -> Figures {
         const auto interface = run.summary.find("border");
         // Adaptive windows stay below the limit; one beyond it is repeated.
         if (interface == run.summary.end() || run.scene.coupling.adaptive) return std::nullopt;
         std::vector<Figure> figures;
         for (const auto& [name, body] : interface->items())
           if (body.contains("omega_H") && body.contains("stable_omega_H"))
             figures.push_back({"body '" + name + "'",
                                body["omega_H"].get<double>() == 0
                                    ? 0
                                    : body["omega_H"].get<double>() / body["stable_omega_H"].get<double>()});
         return figures.empty() ? Figures() : figures;
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         const Json& body = run.summary["border"][f.of.substr(6, f.of.size() - 7)];
         std::string use;
         if (body.value("stable_window_s", 0.0) > 0)
           use = fmt::format("coupling.window = {:.2g} s (now {:.2g})", body["stable_window_s"].get<double>(),
                             run.scene.coupling.window);
         const std::string scheme = body.value("stable_scheme", "implicit");
         if (scheme != "implicit" || run.scene.coupling.scheme != scene::Scheme::implicit || use.empty())
           use += fmt::format("{}coupling.scheme = \"{}\"", use.empty() ? "" : ", or ", scheme);
         return fmt::format(
             "{} vibrates on its contacts with omega H = {:.3g}, {:.2g} times the limit of "
             "stability of the scheme (limit "
             "{:.2g}): use {}",
             f.of, body["omega_H"].get<double>(), f.value, limit, use);
       }});
  table.push_back(
      {"window_error", "windows_of_too_large_error / windows", 0.01,
       "share of the windows that have the shortest length allowed and an error above the tolerance",
       "a smaller `coupling.adaptive.min_window`", nullptr,
       [](const RunFigures& run) {
         return share(run.number("windows_of_too_large_error"), run.number("windows"));
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         const double shortest = run.scene.coupling.adaptive ? run.scene.coupling.adaptive->min_window : 0,
                      micro_step = run.facts.dem.micro_step.value_or(0);
         // A window has at least one micro step.
         const std::string finer =
             0.1 * shortest < micro_step
                 ? fmt::format(" and dem.micro_step = {:.2g} s (now {:.2g})", 0.1 * shortest, micro_step)
                 : "";
         return fmt::format(
             "{:.2g} of the windows have the shortest length allowed and an error above the tolerance "
             "(limit {:.2g}): use coupling.adaptive.min_window = {:.2g} s (now {:.2g}){}",
             f.value, limit, 0.1 * shortest, shortest, finer);
       }});
}

}  // namespace tandem::launch
