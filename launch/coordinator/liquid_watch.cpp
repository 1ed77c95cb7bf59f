#include "launch/coordinator/liquid_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "launch/coordinator/schemes.hpp"

namespace tandem::launch {
namespace {

// Growth per window that is invisible in a run of some thousand windows.
constexpr double negligible_growth = 1e-4;
// A body that passes less than this share of a change of velocity to the liquid in a window is heavy.
constexpr double negligible_share = 1e-3;

}  // namespace

std::vector<std::pair<LiquidMode, Vector6>> liquid_modes(const protocol::BodyResponse& response,
                                                         const scene::Body& body,
                                                         const scene::Freedom& freedom, const Pose& pose,
                                                         double micro_step) {
  std::vector<std::pair<LiquidMode, Vector6>> result;
  const Eigen::Map<const Matrix6> added(response.added_mass.data());
  for (const BodyMode& mode : modes_of(response.radiation, body, freedom, pose)) {
    const double ratio = mode.shape.dot(added * mode.shape);
    if (mode.value > 0 && ratio > 0)
      result.push_back({{mode.value, ratio, response.delay / micro_step, micro_step}, mode.shape});
  }
  return result;
}

Matrix6 passed_in(const protocol::BodyResponse& response, const scene::Body& body,
                  const scene::Freedom& freedom, const Pose& pose, double window) {
  Matrix6 sum = Matrix6::Zero();
  const Matrix6 mass = mass_matrix(body, pose);
  for (const auto& [mode, shape] : liquid_modes(response, body, freedom, pose, window)) {
    const Vector6 momentum = mass * shape;
    sum += mode.passed(window) * momentum * momentum.transpose();
  }
  return sum;
}

LiquidWatch::LiquidWatch(const scene::Scene& scene) : scene_(scene) {
  if (scene.mbd) freedoms_ = scene::freedoms_of(*scene.mbd);
}

std::optional<std::string> LiquidWatch::observe(const std::vector<protocol::BodyResponse>& responses,
                                                const protocol::MotionSet& motion, double micro_step) {
  const double H = motion.window.length();
  stable_window_ = std::numeric_limits<double>::infinity();
  std::optional<std::string> news;
  for (const protocol::BodyResponse& response : responses) {
    const auto end = std::ranges::find(motion.bodies, response.body, &protocol::BodyMotion::body);
    if (end == motion.bodies.end()) continue;
    LiquidFigures now;
    std::optional<LiquidMode> worst;
    for (const auto& [mode, shape] : liquid_modes(response, scene_.mbd->bodies[response.body],
                                                  freedoms_[response.body], end->end_pose, micro_step)) {
      if (mode.passed(H + mode.delay_in(H)) < negligible_share) continue;
      const double growing = growth(scene_.coupling, mode, H);
      if (scene_.coupling.adaptive)
        stable_window_ = std::min(stable_window_, critical_window(scene_.coupling, mode));
      if (worst && !(growing > now.growth + 1e-9 || (growing > now.growth - 1e-9 && mode.rate > worst->rate)))
        continue;
      worst = mode;
      now = {mode.ratio, mode.rate * H, growing, 0};
    }
    if (!worst) continue;
    LiquidFigures& figures = figures_[response.body];
    now.windows_beyond = figures.windows_beyond;
    const bool beyond = now.growth > 1 + negligible_growth;
    if (beyond && now.windows_beyond++ == 0)
      news = (news ? *news + "; " : std::string()) + warning(response.body, now, *worst, motion.window);
    if (now.growth >= figures.growth)
      figures = now;
    else
      figures.windows_beyond = now.windows_beyond;
  }
  return news;
}

std::string LiquidWatch::warning(std::uint32_t body, const LiquidFigures& now, const LiquidMode& mode,
                                 const Window& window) const {
  const double H = window.length();
  const scene::Scheme scheme = scene_.coupling.scheme;
  std::string remedy;
  scene::Coupling other;
  other.scheme = scene::Scheme::implicit;
  if (scheme != other.scheme) {
    remedy = "use coupling.scheme = \"implicit\"";
  } else {
    LiquidMode finer = mode;
    for (int steps = 2; steps <= 20 && growth(other, finer, H) > 1 + negligible_growth; ++steps)
      finer.step = H / steps;
    if (finer.step < mode.step)
      remedy = fmt::format("use steps of the liquid of {:.2g} s, {:.0f} in a window, or a longer window",
                           finer.step, H / finer.step);
  }
  if (const double stable = critical_window(scene_.coupling, mode); stable > 0 && stable < H)
    remedy += fmt::format("{}scheme {} would need coupling.window = {:.2g} s", remedy.empty() ? "" : "; ",
                          name(scheme), 0.9 * stable);
  return fmt::format(
      "body '{}' is light for the liquid on it: in window {} of {:.3g} s ({:.0f} steps of the liquid) the "
      "damping by its sound is {:.3g} m/H, and its added mass within a window is {:.3g} of its own (estimate): scheme {} "
      "multiplies a change of its velocity by {:.3g} in each window: {}",
      scene_.mbd->bodies[body].name, window.index, H, std::max(1.0, std::round(H / mode.step)), now.radiation_H,
      mode.passed(H + mode.delay_in(H)), name(scheme), now.growth, remedy);
}

void LiquidWatch::save_or_restore(Archive& archive) {
  archive("liquid_watch/figures", figures_);
  archive("liquid_watch/window", stable_window_);
  archive.expect(stable_window_ >= 0 && (scene_.coupling.adaptive || std::isinf(stable_window_)),
                 "liquid_watch/window", "it is no time");
  for (const auto& [body, f] : figures_)
    archive.expect(scene_.mbd && body < scene_.mbd->bodies.size() && std::isfinite(f.ratio) && f.ratio >= 0 &&
                       std::isfinite(f.radiation_H) && f.radiation_H >= 0 && f.growth >= 0,
                   "liquid_watch/figures", "no body is in a liquid like that");
}

}  // namespace tandem::launch
