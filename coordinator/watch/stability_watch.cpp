#include "coordinator/watch/stability_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/schemes/body_modes.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "coordinator/schemes/window_map.hpp"

namespace tandem::launch {
namespace {

// Below this value a window is uncritical: the contacts on the body are soft.
constexpr double negligible_omega_H = 1e-3;
// Growth per window that is invisible in a run of some thousand windows.
constexpr double negligible_growth = 1e-5;

// Whether a vibration is nearer to the limit of stability, or further beyond it. All stable vibrations grow
// alike: of these the fastest is worse.
bool is_worse(const Vibration& a, const Vibration& b) {
  const double growth_a = std::max(a.growth, 1 + negligible_growth),
               growth_b = std::max(b.growth, 1 + negligible_growth);
  return growth_a > growth_b || (growth_a == growth_b && a.omega_H > b.omega_H);
}

}  // namespace

StabilityWatch::StabilityWatch(const scene::Scene& scene) : scene_(scene) {
  if (scene.mbd) freedoms_ = scene::freedoms_of(*scene.mbd);
}

std::vector<StabilityWatch::Mode> StabilityWatch::modes(const protocol::BodyTangent& tangent,
                                                        const protocol::BodyTangent* support,
                                                        const Pose& pose) const {
  std::vector<Mode> result;
  for (const BodyMode& found :
       modes_of(tangent.stiffness, scene_.mbd->bodies[tangent.body], freedoms_[tangent.body], pose)) {
    if (!(found.value > 0)) continue;
    const auto along = [&found](const std::array<double, 36>& matrix) {
      return std::max(0.0, found.shape.dot(Eigen::Map<const Matrix6>(matrix.data()) * found.shape));
    };
    const double omega = std::sqrt(found.value);
    Mode& mode = result.emplace_back();
    mode.omega = omega;
    mode.zeta = along(tangent.damping) / (2 * omega);
    if (support)
      mode.support = {along(support->stiffness) / (omega * omega), along(support->damping) / omega};
  }
  return result;
}

std::optional<std::string> StabilityWatch::observe(const protocol::TangentSet& tangents,
                                                   const protocol::TangentSet& supports,
                                                   const protocol::MotionSet& motion) {
  const double H = motion.window.length();
  stable_window_ = std::numeric_limits<double>::infinity();
  std::optional<std::string> news;
  for (const protocol::BodyTangent& tangent : tangents.bodies) {
    const auto end = std::find_if(motion.bodies.begin(), motion.bodies.end(),
                                  [&](const auto& m) { return m.body == tangent.body; });
    if (end == motion.bodies.end()) continue;
    StabilityFigures& figures = figures_[tangent.body];
    Vibration& now = figures.now = {};
    const auto support = std::ranges::find(supports.bodies, tangent.body, &protocol::BodyTangent::body);
    const protocol::BodyTangent* const held = support == supports.bodies.end() ? nullptr : &*support;
    for (const Mode& mode : modes(tangent, held, end->end_pose)) {
      const double omega_H = mode.omega * H;
      if (omega_H < negligible_omega_H) continue;
      const double growing = growth(scene_.coupling, omega_H, mode.zeta, mode.support);
      if (scene_.coupling.adaptive && growing > 1 + negligible_growth)
        stable_window_ =
            std::min(stable_window_, critical_omega_H(scene_.coupling, mode.zeta, mode.support) / mode.omega);
      const Vibration vibration{omega_H, mode.zeta, growing, mode.support};
      if (is_worse(vibration, now)) now = vibration;
    }
    if (is_worse(now, figures.worst)) figures.worst = now;
    if (now.growth <= 1 + negligible_growth || figures.windows_beyond++ > 0) continue;
    figures.limit = critical_omega_H(scene_.coupling, now.zeta, now.support);
    news = (news ? *news + "; " : std::string()) + warning(tangent.body, figures, H);
  }
  return news;
}

void StabilityWatch::save_or_restore(Archive& archive, std::uint64_t calls) {
  archive("stability/figures", figures_);
  archive("stability/window", stable_window_);
  archive.expect(stable_window_ > 0 && (scene_.coupling.adaptive || std::isinf(stable_window_)),
                 "stability/window", "it is no time");
  for (const auto& [body, figures] : figures_) {
    const auto expect = [&archive](bool sound, const char* problem) {
      archive.expect(sound, "stability/figures", problem);
    };
    expect(scene_.mbd && body < scene_.mbd->bodies.size(), "there is no such body");
    for (const Vibration& v : {figures.now, figures.worst})
      expect(std::isfinite(v.omega_H) && v.omega_H >= 0 && std::isfinite(v.zeta) && v.zeta >= 0 &&
                 v.growth >= 0 && std::isfinite(v.support.stiffness) && v.support.stiffness >= 0 &&
                 std::isfinite(v.support.damping) && v.support.damping >= 0,
             "no body vibrates like that");
    expect(!is_worse(figures.now, figures.worst), "the worst vibration is not the worst");
    expect(figures.limit >= 0, "the limit of stability is no number of at least 0");
    expect(figures.windows_beyond <= calls, "more windows are beyond the limit than there were");
  }
}

StabilityRemedy StabilityWatch::remedy(const Vibration& of_window) const {
  return remedy(of_window, scene_.coupling.window);
}

StabilityRemedy StabilityWatch::remedy(const Vibration& f, double H) const {
  StabilityRemedy remedy;
  const double limit = critical_omega_H(scene_.coupling, f.zeta, f.support);
  if (limit > 0) remedy.window = 0.9 * limit / f.omega_H * H;
  remedy.omega_H = std::max(limit, 1e-2);  // start of the search for the limit
  // On a support a window may be stable beyond the first limit.
  if (f.growth <= 1 + negligible_growth) remedy.omega_H = std::max(remedy.omega_H, f.omega_H);
  for (const scene::Scheme scheme : {scene::Scheme::dem_first, scene::Scheme::linear_implicit}) {
    scene::Coupling other;
    other.scheme = scheme;
    if (growth(other, f.omega_H, f.zeta, f.support) > 1 + negligible_growth) continue;
    remedy.scheme = name(scheme);
    break;
  }
  return remedy;
}

std::string StabilityWatch::warning(std::uint32_t body, const StabilityFigures& figures, double H) const {
  const Vibration& f = figures.now;
  const StabilityRemedy use = remedy(f, H);
  std::string remedy;
  if (use.window > 0) remedy = fmt::format("coupling.window = {:.2g} s would be stable", use.window);
  if (!use.scheme.empty())
    remedy += fmt::format(
        "{}scheme {}{} would be stable with this window", remedy.empty() ? "" : "; ", use.scheme,
        use.scheme == name(scene_.coupling.scheme) ? " without coupling.load and coupling.path" : "");
  std::string support;
  if (f.support.stiffness > 0)
    support = fmt::format(", and on those with other bodies with omega H = {:.3g}",
                          std::sqrt(f.support.stiffness) * f.omega_H);
  return fmt::format(
      "body '{}' vibrates on its contacts with omega H = {:.3g}, zeta = {:.2g}{} (estimate); scheme {} is "
      "stable up to "
      "{:.3g}: {}",
      scene_.mbd->bodies[body].name, f.omega_H, f.zeta, support, name(scene_.coupling.scheme), figures.limit,
      remedy);
}

}  // namespace tandem::launch
