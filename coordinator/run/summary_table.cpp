// The summary as the table that a run prints.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/utf8.hpp"
#include "coordinator/run/summary.hpp"

namespace tandem::launch {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump();
}

}  // namespace

std::string Summary::table() const {
  const bool suspect = status_ == Status::suspect;
  std::string text =
      fmt::format("{}: {}\n", json_["scene"].get<std::string>(), suspect ? "SUSPECT" : name(status_));
  const auto row = [&](const char* title, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", title, value);
  };
  const auto number_row = [&](const char* title, const char* key, const char* unit) {
    if (json_.contains(key) && !json_[key].is_null()) row(title, text_of(json_[key]) + unit);
  };
  for (const VerdictLine& line : verdict_.lines) row("SUSPECT", line.sentence);
  for (const protocol::Role role : protocol::all_roles) {
    const auto server = json_.find(protocol::name(role));
    if (server != json_.end() && server->is_object() && server->contains("command"))
      row(protocol::name(role),
          fmt::format("{}, started by {}", text_of((*server)["program"]), text_of((*server)["command"])));
  }
  const protocol::DemFacts& dem = facts_.dem;
  if (dem.backend || dem.spheres) {
    std::string particles =
        dem.spheres ? fmt::format("{} spheres", *dem.spheres) : std::string("number of spheres unknown");
    if (dem.backend) particles += " on " + *dem.backend;
    if (dem.device) particles += " (" + *dem.device + ")";
    if (number("ranks") > 1) particles += fmt::format(", {} ranks", text_of(json_["ranks"]));
    for (const auto& word : {dem.variant, dem.precision})
      if (word) particles += ", " + *word;
    row("particles", particles);
  } else if (json_["dem_server"].is_object()) {
    row("particles", not_reported(protocol::Role::dem));
  }
  if (const protocol::SphFacts& sph = facts_.sph; sph.particles) {
    const bool comes = sph.came_in.value_or(0) + sph.went_out.value_or(0) > 0;
    std::string liquid = fmt::format("{} particles{}", *sph.particles, comes ? " at the start" : "");
    if (sph.backend) liquid += " on " + *sph.backend;
    if (sph.precision) liquid += ", " + *sph.precision;
    row("liquid", liquid);
  } else if (json_.contains("sph_server") && json_["sph_server"].is_object()) {
    row("liquid", not_reported(protocol::Role::sph));
  }
  std::string course =
      fmt::format("{:.6g} s in {} windows", number("simulated_s"), text_of(json_["windows"]));
  if (number("windows_rejected") > 0)
    course += fmt::format(" (and {} taken back)", text_of(json_["windows_rejected"]));
  if (number("iterations_per_window") > 1)
    course += fmt::format(", {} iterations each", text_of(json_["iterations_per_window"]));
  if (number("micro_steps") > 0) course += fmt::format(" and {} micro steps", text_of(json_["micro_steps"]));
  row("simulated", course);
  const Json& split = json_["time_split"];
  // A program that does not take part is left out.
  std::string parts;
  for (const char* part : {"dem", "mbd", "sph", "exchange", "output"}) {
    const auto program = json_.find(std::string(part) + "_server");
    if (split.contains(part) && (program == json_.end() || program->is_object()))
      parts += fmt::format("{} {} {:.3g}", parts.empty() ? ":" : ",", part, split[part].get<double>());
  }
  row("wall time", fmt::format("{:.3g} s{}", number("wall_s"), parts));
  number_row("per micro step", "us_per_micro_step", " us");
  number_row("sphere-steps", "sphere_steps_per_s", " /s");
  number_row("impulse closure", "impulse_closure", "");
  if (number("impulse_outstanding") > 0) number_row("impulse outstanding", "impulse_outstanding", "");
  number_row("energy residual", "energy_residual", "");
  number_row("momentum balance", "momentum_balance", "");
  if (facts_.mbd.constraint_violation)
    row("constraint violation", fmt::format("{:.6g}", *facts_.mbd.constraint_violation));
  number_row("largest overlap", "max_overlap_ratio", " of the radius");
  if (json_.contains("sph")) {
    const Json& liquid = json_["sph"];
    const auto liquid_row = [&](const char* title, const char* key, const char* unit) {
      if (liquid.contains(key)) row(title, text_of(liquid[key]) + unit);
    };
    liquid_row("liquid momentum", "momentum_balance", "");
    liquid_row("liquid density error", "density_error", "");
    liquid_row("liquid volume error", "volume_error", "");
    liquid_row("liquid Mach number", "mach", "");
    liquid_row("liquid came in", "came_in", " particles");
    liquid_row("liquid went out", "went_out", " particles");
    if (facts_.sph.lost.value_or(0) > 0) liquid_row("liquid lost", "lost_kg", " kg");
  }
  if (dem.spheres > 0 || number("lost_particles") > 0) number_row("lost particles", "lost_particles", "");
  if (dem.came_in) row("came in", fmt::format("{} spheres", *dem.came_in));
  if (dem.went_out) row("went out", fmt::format("{} spheres", *dem.went_out));
  number_row("state hash", "state_hash", "");
  for (const Json& check : json_["checks"]) {
    row(check["passed"].get<bool>() ? "check passed" : "CHECK FAILED",
        fmt::format("{}: {} (expected {}, tolerance {}{})", check["name"].get<std::string>(),
                    text_of(check["value"]), text_of(check["expected"]), text_of(check["tolerance"]),
                    check["absolute"].get<bool>() ? "" : " relative"));
  }
  for (const Json& warning : json_["warnings"]) row("warning", text_of(warning));
  for (const std::string& what : verdict_.not_judged) row("not judged", what);
  return text;
}

}  // namespace tandem::launch
