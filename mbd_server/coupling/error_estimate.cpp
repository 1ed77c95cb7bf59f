#include "mbd_server/coupling/error_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tandem::mbd {
namespace {

struct Difference {
  double position = 0, rotation = 0, energy = 0, motion = 0;
};

Difference operator-(const RunEnd& a, const RunEnd& b) {
  Difference d;
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    d.position = std::max(d.position, norm(a.bodies[k].p_WB - b.bodies[k].p_WB));
    d.rotation = std::max(d.rotation, norm(rotation_vector(a.bodies[k].q_WB * b.bodies[k].q_WB.conjugate())));
  }
  d.energy = std::abs(a.energy - b.energy);
  d.motion = std::abs(a.motion - b.motion);
  return d;
}

}  // namespace

ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& coarse, const RunEnd& coarser) {
  // Squares of the ratios of the steps. Steps that end at breaks are as long in all runs.
  const double r2 = coarse.cubed_steps / run.cubed_steps, r2_coarser = coarser.cubed_steps / run.cubed_steps;
  if (!(r2 > 2 && r2_coarser > 1.5 * r2)) return {.reason = "most steps end at breaks of functions of time"};
  const double expected = (r2_coarser - 1) / (r2 - 1);
  const Difference d = coarse - run, d2 = coarser - run;
  // Differences below `round_off` carry no information about the order.
  const auto error = [&](double one, double two, double round_off) -> std::optional<double> {
    if (two > round_off && !(two > expected / 2 * one && two < expected * 2 * one)) return {};
    return std::max(one / (r2 - 1), two / (r2_coarser - 1));
  };
  double size = 0;
  for (const Pose& body : run.bodies) size = std::max(size, norm(body.p_WB));
  ErrorEstimate e{.position = error(d.position, d2.position, 1e-10 * size),
                  .rotation = error(d.rotation, d2.rotation, 1e-10),
                  .motion = error(d.motion, d2.motion, 1e-6),
                  .energy = error(d.energy, d2.energy, 1e-10 * std::abs(run.energy))};
  if (!e.position || !e.rotation || !e.motion || !e.energy) e.reason = unresolved;
  return e;
}

// The difference of one run alone. Where small errors grow so much that it is as large as the motion itself,
// as in a chaotic one, the run with shorter steps is as far from the truth.
void complete_estimate(const RunEnd& run, const RunEnd& coarse, ErrorEstimate& estimate) {
  const double r2 = coarse.cubed_steps / run.cubed_steps;
  if (!(r2 > 2)) return;
  const Difference d = coarse - run;
  const auto complete = [&](std::optional<double>& figure, double difference) {
    if (!figure) figure = difference / (r2 - 1);
  };
  complete(estimate.position, d.position);
  complete(estimate.rotation, d.rotation);
  complete(estimate.motion, d.motion);
  complete(estimate.energy, d.energy);
  estimate.reason.clear();
}

ErrorEstimate estimate_error(const RunEnd& run, const RunEnd& fine, bool halved) {
  const double s = halved ? 2 : fine.steps / run.steps;
  const Difference d = run - fine;
  if (s < 1.5)
    return {
        .reason = fmt::format(
            "the run with shorter steps took only {:.2g} times as many steps, and differs by {:.2g} m and "
            "{:.2g} rad at the end; give mbd.integrator.step",
            s, d.position, d.rotation)};
  const double factor = s * s / (s * s - 1);
  return {.position = factor * d.position,
          .rotation = factor * d.rotation,
          .motion = factor * d.motion,
          .energy = factor * d.energy};
}

void add_error_facts(const ErrorEstimate& error, protocol::MbdFacts& facts, nlohmann::ordered_json& others) {
  const auto or_reason = [&](const std::optional<double>& figure) {
    return protocol::fact::Estimate{figure, figure ? "" : "not estimated: " + error.reason};
  };
  const auto as_json = [&](const std::optional<double>& figure) {
    return figure ? nlohmann::ordered_json(*figure) : nlohmann::ordered_json(or_reason(figure).reason);
  };
  // The largest of three: relative to the size of the machine, in rad, and of a coordinate relative to how
  // far it has moved.
  std::optional<double> relative = error.motion;
  if (error.position && error.rotation && (error.motion || error.reason.find(unresolved) != 0))
    relative = std::max({*error.position / facts.size.value(), *error.rotation, error.motion.value_or(0)});
  others["mbd_position_error_estimate_m"] = as_json(error.position);
  facts.position_error = or_reason(relative);
  others["mbd_rotation_error_estimate_rad"] = as_json(error.rotation);
  facts.energy_error = or_reason(error.energy);
  others["mbd_error_estimate_steps"] = static_cast<std::uint64_t>(error.steps);
  others["mbd_error_estimate_cpu_seconds"] = error.cpu_seconds;
}

}  // namespace tandem::mbd
