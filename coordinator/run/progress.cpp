#include "coordinator/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace tandem::launch {
namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(Nanoseconds begin, std::uint64_t micro_steps, Nanoseconds end, bool quiet)
    : start_(begin),
      end_(end),
      steps_before_(micro_steps),
      quiet_(quiet),
      terminal_(isatty(STDOUT_FILENO) == 1),
      begin_(Clock::now()),
      last_(begin_) {}

Progress::~Progress() {
  if (written_ && terminal_) std::fputs("\n", stdout);
}

std::string Progress::line(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps,
                           std::uint64_t spheres, double elapsed) const {
  const double share = static_cast<double>(now.count) / static_cast<double>(end_.count);
  std::string text = fmt::format("t = {:.4g} of {:.4g} s ({:.0f} %), {} windows", to_seconds(now),
                                 to_seconds(end_), 100 * share, windows);
  if (micro_steps > 0) {
    const double rate = static_cast<double>(micro_steps - steps_before_) / elapsed;
    text += fmt::format(", {:.3g} micro steps/s", rate);
    if (spheres > 0) text += fmt::format(", {:.3g} sphere-steps/s", rate * static_cast<double>(spheres));
  }
  const double left = static_cast<double>((end_ - now).count) / static_cast<double>((now - start_).count);
  return text + fmt::format(", {} left", duration(elapsed * left));
}

void Progress::update(Nanoseconds now, std::uint64_t windows, std::uint64_t micro_steps,
                      std::uint64_t spheres) {
  using namespace std::chrono_literals;
  const auto wall = Clock::now();
  const bool last = now >= end_;
  if (quiet_ || (wall - last_ < (terminal_ ? 200ms : 10'000ms) && !(last && written_))) return;
  last_ = wall;
  written_ = true;
  const std::string text =
      line(now, windows, micro_steps, spheres, std::chrono::duration<double>(wall - begin_).count());
  // Erases the rest of the line: the new text may be shorter.
  const std::string shown = fmt::format("{}{}{}", terminal_ ? "\r" : "", text, terminal_ ? "\033[K" : "\n");
  // A closed terminal takes no text, which is not an error of the run.
  std::fputs(shown.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace tandem::launch
