#include "coordinator/window/window_log.hpp"

#include <fmt/format.h>

#include <iterator>

namespace tandem::launch {

namespace {

std::string columns_of_windows(const scene::Scene& scene) {
  std::string columns =
      "window,time,micro_steps,contacts,rebuilds,kinetic_energy,max_overlap_ratio,lost_particles,"
      "impulse_closure,energy_created,energy_exchanged,momentum_balance,length,iterations,rejected";
  if (scene.sph)
    columns += ",liquid_micro_steps,liquid_rebuilds,liquid_kinetic_energy,liquid_momentum_balance";
  return columns;
}

}  // namespace

WindowLog::WindowLog(const std::filesystem::path& folder, const scene::Scene& scene)
    : scene_(scene),
      windows_(folder / "windows.csv", columns_of_windows(scene)),
      interface_(folder / "border.csv",
                 "window,time,body,booked.x,booked.y,booked.z,applied.x,applied.y,applied.z,"
                 "booked_turn.x,booked_turn.y,booked_turn.z,applied_turn.x,applied_turn.y,applied_turn.z,"
                 "work_given,work_received,omega_H,zeta") {}

void WindowLog::write(const Coupler& coupler) {
  const Accounts& accounts = coupler.accounts();
  const protocol::ParticleAccount& particles = accounts.particles().account();
  const Window& window = coupler.last_window();
  std::string row =
      fmt::format("{},{:.9g},{},{},{},{:.9g},{:.6g},{},{:.3g},{:.9g},{:.9g},{:.3g},{:.9g},{},{}",
                  window.index, to_seconds(window.end), particles.micro_steps, particles.contacts,
                  particles.rebuilds, particles.kinetic_energy, particles.max_overlap_ratio,
                  particles.lost_particles, accounts.impulse_closure(), accounts.energy_created(),
                  accounts.energy_exchanged(), accounts.particles().momentum(), window.length(),
                  coupler.exchange().iterations, coupler.counters().rejected);
  if (scene_.sph) {
    const ParticleBalance& balance = accounts.particles(place_of_liquid(scene_));
    const protocol::ParticleAccount& liquid = balance.account();
    row += fmt::format(",{},{},{:.9g},{:.3g}", liquid.micro_steps, liquid.rebuilds, liquid.kinetic_energy,
                       balance.momentum());
  }
  windows_.append(row + "\n");
  write_interface(coupler);
}

void WindowLog::write_interface(const Coupler& coupler) {
  const Window& window = coupler.last_window();
  rows_.clear();
  const auto out = std::back_inserter(rows_);
  for (const BodyBalance& body : coupler.accounts().last().bodies) {
    if (!body.loaded) continue;
    fmt::format_to(out, "{},{:.9g},{}", window.index, to_seconds(window.end),
                   scene_.mbd->bodies[body.body].name);
    for (const Vec3d& v :
         {body.recorded.force, body.applied.force, body.recorded.torque, body.applied.torque})
      fmt::format_to(out, ",{:.12g},{:.12g},{:.12g}", v.x, v.y, v.z);
    const auto figures = coupler.watch().bodies().find(body.body);
    fmt::format_to(out, ",{:.12g},{:.12g}", body.given, body.received);
    if (figures == coupler.watch().bodies().end())
      rows_ += ",,\n";
    else
      fmt::format_to(out, ",{:.4g},{:.4g}\n", figures->second.now.omega_H, figures->second.now.zeta);
  }
  if (!rows_.empty()) interface_.append(rows_);
}

}  // namespace tandem::launch
