#include "launch/coordinator/window_log.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace tandem::launch {

WindowLog::WindowLog(const std::filesystem::path& file) : path_(file), file_(file) {
  file_ << "window,time,micro_steps,contacts,rebuilds,kinetic_energy,max_overlap_ratio,lost_particles,"
           "impulse_closure,energy_created,energy_exchanged,momentum_balance\n";
}

void WindowLog::write(const Window& window, const Accounts& accounts) {
  const protocol::ParticleAccount& particles = accounts.particles();
  file_ << fmt::format("{},{:.9g},{},{},{},{:.9g},{:.6g},{},{:.3g},{:.9g},{:.9g},{:.3g}\n", window.index,
                       to_seconds(window.end), particles.micro_steps, particles.contacts, particles.rebuilds,
                       particles.kinetic_energy, particles.max_overlap_ratio, particles.lost_particles,
                       accounts.impulse_closure(), accounts.energy_created(), accounts.energy_exchanged(),
                       accounts.momentum_balance());
  // Whoever looks at a run that goes on, or that was killed, finds its last window.
  file_.flush();
  if (!file_) {
    throw Error(ErrorCode::resource, "cannot be written: " + std::string(strerror(errno)), path_.string(),
                "free some space on the disk");
  }
}

}  // namespace tandem::launch
