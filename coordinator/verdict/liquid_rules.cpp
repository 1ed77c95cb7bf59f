#include <fmt/format.h>

#include <cmath>

#include "coordinator/verdict/figures.hpp"
#include "coordinator/verdict/rules.hpp"
#include "sph_server/equations/limits.hpp"

namespace tandem::launch {
namespace {

constexpr const char* the_liquid = "the liquid";

Figures of_liquid(std::optional<double> value) {
  if (!value) return std::nullopt;
  return std::vector<Figure>{{the_liquid, *value}};
}

// A number that the coordinator has measured of the liquid.
std::optional<double> measured(const RunFigures& run, const char* key) {
  const auto block = run.summary.find("sph");
  if (block == run.summary.end()) return std::nullopt;
  const auto found = block->find(key);
  if (found == block->end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

// "use a sound_speed of 30 m/s (now 20)", for one that is `factor` times larger.
std::string faster_sound(const RunFigures& run, double factor) {
  const auto now = run.facts.sph.sound_speed;
  return now ? fmt::format("use a sound_speed of {:.3g} m/s (now {:.3g})", factor * *now, *now)
             : fmt::format("use a speed of sound {:.2g} times as large", factor);
}

}  // namespace

void add_liquid_rules(std::vector<Rule>& table) {
  table.push_back(
      {"liquid_density", "sph.dense_share", sph::largest_dense_share,
       "share of the mass whose density is off by more than 0.03: a liquid is meant to keep its density; "
       "volumes and pressures are off by about as much; single droplets and the first instant of an impact "
       "do not count",
       "a larger speed of sound", nullptr,
       [](const RunFigures& run) { return of_liquid(run.facts.sph.dense_share); },
       [](const RunFigures& run, const Figure& f, double limit) {
         const double error = run.facts.sph.dense_error.value_or(sph::largest_density_error);
         return fmt::format(
             "the density of up to {:.2g} of the mass of the liquid is off by more than {:.2g} (limit {:.2g} "
             "of "
             "the mass), by up to {:.2g} in the mean: {}; the step becomes shorter by the same factor",
             f.value, sph::largest_density_error, limit, error,
             faster_sound(run, sph::sound_factor_for_density(error)));
       }});
  table.push_back({"mach", "sph.fast_share", sph::largest_fast_share,
                   "share of the mass that has more than 0.2 of the speed of sound: its stagnation pressure "
                   "is off by more "
                   "than 1 %, and compresses it by more than 2 %; single droplets do not count",
                   "a larger speed of sound", nullptr,
                   [](const RunFigures& run) { return of_liquid(run.facts.sph.fast_share); },
                   [](const RunFigures& run, const Figure& f, double limit) {
                     const double mach = run.facts.sph.fast_mach.value_or(sph::largest_flow_mach);
                     const double factor = sph::sound_factor_for_mach(mach);
                     return fmt::format(
                         "up to {:.2g} of the mass of the liquid has more than {:.2g} of the speed of sound "
                         "(limit {:.2g} "
                         "of the mass), up to {:.2g} in the mean: {}, or an expected_speed of {:.2g} m/s",
                         f.value, sph::largest_flow_mach, limit, mach, faster_sound(run, factor),
                         0.1 * factor * run.facts.sph.sound_speed.value_or(0));
                   }});
  table.push_back({"passed_walls", "sph.passed_walls", 0, "a wall keeps the liquid on its side",
                   "a larger speed of sound, or a smaller spacing", nullptr,
                   [](const RunFigures& run) -> Figures {
                     const auto passed = run.facts.sph.passed_walls;
                     return passed ? of_liquid(static_cast<double>(*passed)) : std::nullopt;
                   },
                   [](const RunFigures& run, const Figure& f, double) {
                     return fmt::format(
                         "{:.0f} times a particle of the liquid passed a wall: {}, or a smaller "
                         "sph.spacing",
                         f.value, faster_sound(run, 1.5));
                   }});
  table.push_back(
      {"lost_liquid", "sph.lost_kg / sph.mass_in_all_kg", 0.001,
       "particles of the liquid that leave `sph.domain` are taken out; where they are meant to leave, use an "
       "outlet",
       "a larger domain, or an outlet", nullptr,
       [](const RunFigures& run) -> Figures {
         const auto lost = run.facts.sph.lost, all = run.facts.sph.mass_in_all;
         if (!lost || !all) return std::nullopt;
         return of_liquid(*lost == 0 ? 0 : *lost / *all);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "{:.3g} of {:.3g} kg of the liquid left the domain, a share of {:.2g} (limit {:.2g}): use a "
             "larger sph.domain, or sph.outlets where it is meant to leave",
             run.facts.sph.lost.value_or(0), run.facts.sph.mass_in_all.value_or(0), f.value, limit);
       }});
  table.push_back(
      {"energy_liquid", "abs(sph.energy_residual_J) / sph.energy_scale_J", 0.01,
       "kinetic energy and energy of compression change by the work of gravity, walls, viscosity and "
       "diffusion; the rest is an error of the integration",
       "a shorter step of the liquid", nullptr,
       [](const RunFigures& run) -> Figures {
         const auto residual = run.facts.sph.energy_residual, scale = run.facts.sph.energy_scale;
         if (!residual || !scale) return std::nullopt;
         return of_liquid(*residual == 0 ? 0 : std::abs(*residual) / *scale);
       },
       [](const RunFigures& run, const Figure& f, double limit) {
         return fmt::format(
             "the balance of energy of the liquid is open by {:.2g} of the energy that moved (limit "
             "{:.2g}): use sph.micro_step = {:.2g} s",
             f.value, limit, 0.5 * run.facts.sph.longest_step.value_or(0));
       }});
  table.push_back(
      {"momentum_liquid", "sph.momentum_balance", 1e-6,
       "the momentum balance of the liquid with gravity and walls closes up to the rounding of its "
       "stored state",
       "precision `double`, or a participant that records all forces", nullptr,
       [](const RunFigures& run) { return of_liquid(measured(run, "momentum_balance")); },
       [](const RunFigures&, const Figure& f, double limit) {
         return fmt::format(
             "the momentum of the liquid is off by {:.2g} of what acts on it (limit {:.0e}): use "
             "\"precision\": \"double\", or a participant that records all forces of walls "
             "(docs/protocol.md)",
             f.value, limit);
       }});
}

}  // namespace tandem::launch
