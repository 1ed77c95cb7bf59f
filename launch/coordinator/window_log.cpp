#include "launch/coordinator/window_log.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace tandem::launch {

WindowLog::WindowLog(const std::filesystem::path& folder, const scene::Scene& scene)
    : scene_(scene), windows_(folder / "windows.csv"), border_(folder / "border.csv") {
  windows_.stream
      << "window,time,micro_steps,contacts,rebuilds,kinetic_energy,max_overlap_ratio,lost_particles,"
         "impulse_closure,energy_created,energy_exchanged,momentum_balance,length,iterations,rejected\n";
  border_.stream << "window,time,body,booked.x,booked.y,booked.z,applied.x,applied.y,applied.z,"
                    "booked_turn.x,booked_turn.y,booked_turn.z,applied_turn.x,applied_turn.y,applied_turn.z,"
                    "work_given,work_received,omega_H,zeta\n";
}

void WindowLog::write(const Coupler& coupler) {
  const Accounts& accounts = coupler.accounts();
  const protocol::ParticleAccount& particles = accounts.particles();
  const Window& window = coupler.last_window();
  windows_.stream << fmt::format(
      "{},{:.9g},{},{},{},{:.9g},{:.6g},{},{:.3g},{:.9g},{:.9g},{:.3g},{:.9g},{},{}\n", window.index,
      to_seconds(window.end), particles.micro_steps, particles.contacts, particles.rebuilds,
      particles.kinetic_energy, particles.max_overlap_ratio, particles.lost_particles,
      accounts.impulse_closure(), accounts.energy_created(), accounts.energy_exchanged(),
      accounts.momentum_balance(), window.length(), coupler.exchange().iterations,
      coupler.counters().rejected);
  windows_.flush();
  write_border(coupler);
}

void WindowLog::write_border(const Coupler& coupler) {
  const Window& window = coupler.last_window();
  for (const BodyBooks& body : coupler.accounts().last().bodies) {
    if (!body.loaded) continue;
    border_.stream << fmt::format("{},{:.9g},{}", window.index, to_seconds(window.end),
                                  scene_.mbd->bodies[body.body].name);
    for (const Vec3d& v : {body.booked.force, body.applied.force, body.booked.torque, body.applied.torque})
      border_.stream << fmt::format(",{:.12g},{:.12g},{:.12g}", v.x, v.y, v.z);
    const auto figures = coupler.watch().bodies().find(body.body);
    border_.stream << fmt::format(",{:.12g},{:.12g}", body.given, body.received);
    if (figures == coupler.watch().bodies().end())
      border_.stream << ",,\n";
    else
      border_.stream << fmt::format(",{:.4g},{:.4g}\n", figures->second.now.omega_H,
                                    figures->second.now.zeta);
  }
  border_.flush();
}

void WindowLog::File::flush() {
  stream.flush();
  if (!stream)
    throw Error(ErrorCode::resource, "cannot be written: " + std::string(strerror(errno)), path.string(),
                "free some space on the disk");
}

}  // namespace tandem::launch
