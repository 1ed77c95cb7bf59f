#include "coordinator/watch/liquid_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coordinator/schemes/schemes.hpp"

namespace tandem::launch {
namespace {

// Growth per window that is invisible in a run of some thousand windows.
constexpr double negligible_growth = 1e-4;
// A body that passes less than this share of a change of velocity to the liquid in a window is heavy.
constexpr double negligible_share = 1e-3;

}  // namespace

LiquidWatch::LiquidWatch(const scene::Scene& scene) : scene_(scene) {
  if (scene.mbd) freedoms_ = scene::freedoms_of(*scene.mbd);
}

std::optional<std::string> LiquidWatch::observe(const std::vector<protocol::BodyResponse>& responses,
                                                const protocol::MotionSet& motion, double micro_step) {
  const double H = motion.window.length();
  stable_window_ = std::numeric_limits<double>::infinity();
  std::optional<std::string> news;
  for (const Response response : by_body(responses)) {
    const std::uint32_t body = response.front().body;
    const auto end = std::ranges::find(motion.bodies, body, &protocol::BodyMotion::body);
    if (end == motion.bodies.end()) continue;
    const Judged& judged = judge(response, end->end_pose, H);
    stable_window_ = std::min(stable_window_, judged.stable_window);
    if (!judged.worst) continue;
    LiquidFigures now = judged.now;
    LiquidFigures& figures = figures_[body];
    now.windows_beyond = figures.windows_beyond;
    if (now.growth > 1 + negligible_growth && now.windows_beyond++ == 0)
      news = (news ? *news + "; " : std::string()) +
             warning(body, now, *judged.worst, motion.window, micro_step);
    if (now.growth >= figures.growth)
      figures = now;
    else
      figures.windows_beyond = now.windows_beyond;
  }
  return news;
}

// A response that only turns with its body is judged once per length of the window.
const LiquidWatch::Judged& LiquidWatch::judge(Response response, const Pose& pose, double H) {
  const std::uint32_t body = response.front().body;
  double size = 0;
  for (const protocol::BodyResponse& point : response)
    size += Eigen::Map<const Matrix6>(point.impulse.data()).trace();
  Judged& judged = judged_[body];
  if (judged.window == H && std::abs(judged.size - size) <= 1e-9 * std::abs(size)) return judged;
  judged = {.window = H, .size = size};
  for (const auto& [mode, shape] :
       liquid_modes(response, scene_.mbd->bodies[body], freedoms_[body], pose, H)) {
    if (mode.impulse.back() < negligible_share) continue;
    const double growing = std::max(1.0, growth(scene_.coupling, mode, H));
    if (scene_.coupling.adaptive && growing > 1 + negligible_growth)
      judged.stable_window = std::min(judged.stable_window, critical_window(scene_.coupling, mode));
    const LiquidFigures figures{mode.impulse.back(), mode.passed(H), growing, 0};
    const bool alike = std::abs(growing - judged.now.growth) < 1e-9;
    if (judged.worst && !(alike ? figures.added > judged.now.added : growing > judged.now.growth)) continue;
    judged.worst = mode;
    judged.now = figures;
  }
  return judged;
}

std::string LiquidWatch::warning(std::uint32_t body, const LiquidFigures& now, const LiquidMode& mode,
                                 const Window& window, double micro_step) const {
  const double H = window.length();
  const scene::Scheme scheme = scene_.coupling.scheme;
  // A shorter window helps with the other schemes only where it has less than a step of the liquid, and costs
  // as many more steps.
  std::string remedy = scheme == scene::Scheme::implicit ? "use windows with six steps of the liquid or more"
                                                         : "use coupling.scheme = \"implicit\"";
  if (const double stable = critical_window(scene_.coupling, mode);
      scheme != scene::Scheme::implicit && stable > 0 && stable < H)
    remedy += fmt::format("; {} would need coupling.window = {:.2g} s", name(scheme), 0.9 * stable);
  return fmt::format(
      "body '{}' is light for the liquid on it: from window {} on, of {:.3g} s with {:.0f} steps of the "
      "liquid, "
      "scheme {} multiplies a change of its velocity by {:.3g} in each window (estimate); the liquid gives "
      "{:.3g} times the change back within a window, and {:.3g} times later: {}",
      scene_.mbd->bodies[body].name, window.index, H, std::max(1.0, std::round(H / micro_step)), name(scheme),
      now.growth, now.passed, now.added, remedy);
}

void LiquidWatch::save_or_restore(Archive& archive) {
  archive("liquid_watch/figures", figures_);
  archive("liquid_watch/window", stable_window_);
  archive.expect(stable_window_ >= 0 && (scene_.coupling.adaptive || std::isinf(stable_window_)),
                 "liquid_watch/window", "it is no time");
  for (const auto& [body, f] : figures_)
    archive.expect(scene_.mbd && body < scene_.mbd->bodies.size() && std::isfinite(f.added) &&
                       std::isfinite(f.passed) && f.growth >= 0,
                   "liquid_watch/figures", "no body is in a liquid like that");
}

}  // namespace tandem::launch
