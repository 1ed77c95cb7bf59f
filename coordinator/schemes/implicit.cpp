#include "coordinator/schemes/implicit.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "coordinator/schemes/liquid_modes.hpp"

namespace tandem::launch {
namespace {

// An iteration whose residual has grown by this factor does not converge any more, and may take the particles
// out of the valid range of their contact law.
constexpr double hopeless = 1e6;

}  // namespace

Implicit::Implicit(const scene::Scene& scene, const Solvers& solvers)
    : solvers_(solvers),
      how_(scene.coupling),
      iteration_(scene.coupling.iteration.value_or(scene::Iteration{})),
      space_(scene, scene.coupling.load == scene::LoadShape::mean ? Departure::straight : Departure::cubic),
      scene_(scene),
      freedoms_(scene::freedoms_of(*scene.mbd)),
      accelerator_(make_accelerator(iteration_)) {
  for (const scene::Body& body : scene.mbd->bodies) names_.push_back(body.name);
}

void Implicit::advance(const Window& window, Exchange& exchange) {
  solvers_.mbd->save();
  save_loads(solvers_);
  predict_path(solvers_, how_.path, window, exchange);
  const protocol::MotionSet predicted = exchange.path;
  Eigen::VectorXd x =
      Eigen::VectorXd::Zero(space_.lengths() * static_cast<Eigen::Index>(predicted.bodies.size()));
  double first = 0;  // residual [m]
  accelerator_->expect(expected_step(predicted, exchange.tangents.responses));

  for (exchange.iterations = 1;; ++exchange.iterations) {
    start_loads(solvers_, exchange.path);
    finish_loads(solvers_, exchange);
    exchange.applied = shaped(exchange.load, how_.load);
    solvers_.mbd->start_advance(exchange.applied);
    exchange.motion = solvers_.mbd->finish_motion();

    const Eigen::VectorXd image = space_.difference(exchange.motion, predicted);
    const double allowed = std::max(iteration_.tolerance * space_.motion(exchange.motion), iteration_.length);
    const double residual = (image - x).norm();
    if (residual <= allowed) break;
    if (exchange.iterations == 1) first = residual;
    if (exchange.iterations == iteration_.max_iterations || !(residual < hopeless * first))
      give_up(window, image - x, allowed, exchange);

    solvers_.mbd->restore();
    restore_loads(solvers_);
    x = accelerator_->next(x, image);
    exchange.path = space_.moved(predicted, x);
  }
  accelerator_->end_window();
}

Eigen::MatrixXd Implicit::expected_step(const protocol::MotionSet& predicted,
                                        const std::vector<protocol::BodyResponse>& responses) const {
  if (responses.empty() || space_.lengths() != 6) return {};
  const auto size = 6 * static_cast<Eigen::Index>(predicted.bodies.size());
  // Grains may answer as well.
  Eigen::MatrixXd step = (scene_.dem ? iteration_.relaxation : 1) * Eigen::MatrixXd::Identity(size, size);
  for (std::size_t b = 0; b < predicted.bodies.size(); ++b) {
    const protocol::BodyMotion& motion = predicted.bodies[b];
    const std::vector<Response> all = by_body(responses);
    const auto found =
        std::ranges::find_if(all, [&motion](Response r) { return r.front().body == motion.body; });
    if (found == all.end()) continue;
    const scene::Body& body = scene_.mbd->bodies[motion.body];
    const double H = predicted.window.length(), L = space_.gyration(motion.body);
    Vector6 lengths;
    lengths << 1, 1, 1, L, L, L;
    // A deviation x of the end changes the velocity by x / H, the mean load by -(passed / H) x / H, and the
    // end of the path under it by half of H^2 / m times that.
    const Matrix6 passed = passed_in(*found, body, freedoms_[motion.body], motion.begin_pose, H),
                  g = 0.5 * mass_matrix(body, motion.begin_pose).inverse() * passed;
    const Matrix6 inverse = (Matrix6::Identity() + g).inverse();
    const auto at = 6 * static_cast<Eigen::Index>(b);
    step.block<6, 6>(at, at) *= lengths.asDiagonal() * inverse * lengths.cwiseInverse().asDiagonal();
  }
  return step;
}

void Implicit::give_up(const Window& window, const Eigen::VectorXd& residual, double allowed,
                       const Exchange& exchange) const {
  Eigen::Index worst = 0;
  const auto of_body = [&](Eigen::Index b) {
    return residual.segment(space_.lengths() * b, space_.lengths()).norm();
  };
  for (Eigen::Index b = 0; b < residual.size() / space_.lengths(); ++b)
    if (of_body(b) > of_body(worst)) worst = b;
  accelerator_->end_window();
  const auto& body = names_[exchange.path.bodies[static_cast<std::size_t>(worst)].body];
  throw NotConverged(
      ErrorCode::numerics,
      fmt::format("the coupling iteration of window {} did not converge in {} iterations: the path of body "
                  "'{}' is still wrong by {:.3g} m, allowed are {:.3g} m",
                  window.index, exchange.iterations, body, residual.norm(), allowed),
      "coupling.iteration",
      iteration_.method == scene::Acceleration::constant
          ? fmt::format("try \"method\": \"iqn_ils\", or a relaxation of {:.2g}",
                        0.25 * iteration_.relaxation)
          : fmt::format("try coupling.window = {:.3g}, a relaxation of {:.2g}, or a larger tolerance",
                        0.5 * window.length(), 0.25 * iteration_.relaxation));
}

}  // namespace tandem::launch
