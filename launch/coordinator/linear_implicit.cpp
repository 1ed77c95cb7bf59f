#include "launch/coordinator/linear_implicit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "launch/coordinator/acceleration.hpp"
#include "launch/coordinator/liquid_watch.hpp"

namespace tandem::launch {
namespace {

// The response of the bodies is linear except for rotations and for joints with friction or stops: as many
// solves as one body has coordinates find it, plus a few.
constexpr int max_solves = 60;
constexpr double tolerance = 1e-9;  // of the change of velocity [-]

const protocol::BodyMotion& motion_of(const protocol::MotionSet& set, std::uint32_t body) {
  return *std::find_if(set.bodies.begin(), set.bodies.end(),
                       [body](const auto& m) { return m.body == body; });
}

}  // namespace

LinearImplicit::LinearImplicit(const scene::Scene& scene, const Solvers& solvers)
    : solvers_(solvers), how_(scene.coupling), space_(scene, Departure::straight), scene_(scene) {
  if (scene.mbd) freedoms_ = scene::freedoms_of(*scene.mbd);
}

void LinearImplicit::advance(const Window& window, Exchange& exchange) {
  predict_path(solvers_, how_.path, window, exchange);
  start_loads(solvers_, exchange.path);
  finish_loads(solvers_, exchange);
  exchange.tangents = linearise_loads(solvers_);
  const protocol::TangentSet tangents = with_responses(exchange);

  // The particle side is replaced by its tangent; only the bodies repeat the window.
  solvers_.mbd->save();
  QuasiNewton accelerator(0.1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * tangents.bodies.size()));
  for (int solve = 1;; ++solve) {
    exchange.applied = shaped(corrected(exchange, tangents, x), how_.load);
    solvers_.mbd->start_advance(exchange.applied);
    exchange.motion = solvers_.mbd->finish_motion();
    const Eigen::VectorXd image = change(exchange, tangents);
    if ((image - x).norm() <= tolerance * image.norm()) return;
    if (solve == max_solves)
      throw Error(ErrorCode::numerics,
                  fmt::format("window {}: the bodies do not settle against the stiffness of their contacts "
                              "in {} solutions",
                              window.index, max_solves),
                  "coupling.scheme", fmt::format("try coupling.window = {:.3g}", 0.5 * window.length()));
    solvers_.mbd->restore();
    x = accelerator.next(x, image);
  }
}

protocol::TangentSet LinearImplicit::with_responses(const Exchange& exchange) const {
  protocol::TangentSet tangents = exchange.tangents;
  const double H = exchange.path.window.length();
  for (const Response response : by_body(exchange.tangents.responses)) {
    const std::uint32_t body = response.front().body;
    auto of = std::ranges::find(tangents.bodies, body, &protocol::BodyTangent::body);
    if (of == tangents.bodies.end()) of = tangents.bodies.insert(of, {.body = body});
    Eigen::Map<Matrix6>(of->damping.data()) += passed_in(response, scene_.mbd->bodies[body], freedoms_[body],
                                                         motion_of(exchange.path, body).begin_pose, H) /
                                               H;
  }
  return tangents;
}

Eigen::VectorXd LinearImplicit::change(const Exchange& exchange, const protocol::TangentSet& tangents) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(6 * tangents.bodies.size()));
  Eigen::Index at = 0;
  for (const protocol::BodyTangent& tangent : tangents.bodies) {
    const Twist &taken = motion_of(exchange.motion, tangent.body).end_twist,
                &predicted = motion_of(exchange.path, tangent.body).end_twist;
    const Vec3d v = taken.v_WB - predicted.v_WB,
                w = space_.gyration(tangent.body) * (taken.w_WB - predicted.w_WB);
    result.segment<6>(at) << v.x, v.y, v.z, w.x, w.y, w.z;
    at += 6;
  }
  return result;
}

protocol::LoadSet LinearImplicit::corrected(const Exchange& exchange, const protocol::TangentSet& tangents,
                                            const Eigen::VectorXd& change) const {
  protocol::LoadSet result = exchange.load;
  const double H = exchange.path.window.length();
  Eigen::Index at = 0;
  for (const protocol::BodyTangent& tangent : tangents.bodies) {
    Vector6 twist = change.segment<6>(at);
    at += 6;
    twist.tail<3>() /= space_.gyration(tangent.body);
    const Vector6 relief = (H * Eigen::Map<const Matrix6>(tangent.stiffness.data()) +
                            Eigen::Map<const Matrix6>(tangent.damping.data())) *
                           twist;
    for (protocol::BodyLoad& load : result.bodies) {
      if (load.body != tangent.body) continue;
      load.mean.force -= Vec3d{relief[0], relief[1], relief[2]};
      load.mean.torque -= Vec3d{relief[3], relief[4], relief[5]};
    }
  }
  return result;
}

}  // namespace tandem::launch
