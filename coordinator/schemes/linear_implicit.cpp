#include "coordinator/schemes/linear_implicit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/error.hpp"
#include "coordinator/schemes/acceleration.hpp"
#include "coordinator/schemes/archive.hpp"
#include "coordinator/schemes/liquid_modes.hpp"

namespace tandem::launch {
namespace {

// The response of the bodies is linear except for rotations and for joints with friction or stops: as many
// solves as one body has coordinates find it, plus a few.
constexpr int max_solves = 60;
constexpr double tolerance = 1e-9;  // of the change of velocity [-]
constexpr double rounding = 1e-13;  // of the velocity [-]

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
  const protocol::TangentSet tangents = tangents_of(exchange);
  const Matrices passed = passed_in_window(exchange);
  if (window.begin.count != last_begin_) ahead_before_ = ahead_;
  last_begin_ = window.begin.count;

  // The particle side is replaced by its tangent; only the bodies repeat the window.
  solvers_.mbd->save();
  QuasiNewton accelerator(0.1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * tangents.bodies.size()));
  for (int solve = 1;; ++solve) {
    exchange.applied = shaped(corrected(exchange, tangents, passed, x, ahead_), how_.load);
    solvers_.mbd->start_advance(exchange.applied);
    exchange.motion = solvers_.mbd->finish_motion();
    const Eigen::VectorXd image = change(exchange, tangents);
    if ((image - x).norm() <= tolerance * image.norm() + rounding * speed(exchange, tangents)) return;
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

protocol::TangentSet LinearImplicit::tangents_of(const Exchange& exchange) const {
  protocol::TangentSet tangents = exchange.tangents;
  for (const Response response : by_body(exchange.tangents.responses)) {
    const std::uint32_t body = response.front().body;
    if (std::ranges::find(tangents.bodies, body, &protocol::BodyTangent::body) == tangents.bodies.end())
      tangents.bodies.push_back({.body = body});
  }
  return tangents;
}

LinearImplicit::Matrices LinearImplicit::passed_in_window(const Exchange& exchange) const {
  Matrices passed;
  for (const Response response : by_body(exchange.tangents.responses)) {
    const std::uint32_t body = response.front().body;
    passed[body] = passed_in(response, scene_.mbd->bodies[body], freedoms_[body],
                             motion_of(exchange.path, body).begin_pose, exchange.path.window.length());
  }
  return passed;
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

double LinearImplicit::speed(const Exchange& exchange, const protocol::TangentSet& tangents) const {
  double sum = 0;
  for (const protocol::BodyTangent& tangent : tangents.bodies) {
    const Twist& twist = motion_of(exchange.motion, tangent.body).end_twist;
    sum += norm(twist.v_WB) + space_.gyration(tangent.body) * norm(twist.w_WB);
  }
  return sum;
}

protocol::LoadSet LinearImplicit::corrected(const Exchange& exchange, const protocol::TangentSet& tangents,
                                            const Matrices& passed, const Eigen::VectorXd& change,
                                            Impulses& ahead) const {
  protocol::LoadSet result = exchange.load;
  ahead.clear();
  const double H = exchange.path.window.length();
  Eigen::Index at = 0;
  for (const protocol::BodyTangent& tangent : tangents.bodies) {
    Vector6 twist = change.segment<6>(at);
    at += 6;
    twist.tail<3>() /= space_.gyration(tangent.body);
    Vector6 relief = (H * Eigen::Map<const Matrix6>(tangent.stiffness.data()) +
                      Eigen::Map<const Matrix6>(tangent.damping.data())) *
                     twist;
    if (const auto of = passed.find(tangent.body); of != passed.end()) {
      const Vector6& now = ahead[tangent.body] = of->second * twist;
      relief += now / H;
    }
    if (const auto before = ahead_before_.find(tangent.body); before != ahead_before_.end())
      relief -= before->second / H;
    for (protocol::BodyLoad& load : result.bodies) {
      if (load.body != tangent.body) continue;
      load.mean.force -= Vec3d{relief[0], relief[1], relief[2]};
      load.mean.torque -= Vec3d{relief[3], relief[4], relief[5]};
    }
  }
  return result;
}

void LinearImplicit::save_or_restore(Archive& archive) {
  std::map<std::uint32_t, std::array<double, 6>> ahead;
  for (const auto& [body, impulse] : ahead_) Eigen::Map<Vector6>(ahead[body].data()) = impulse;
  archive("linear_implicit/ahead", ahead);
  ahead_.clear();
  for (const auto& [body, impulse] : ahead) {
    ahead_[body] = Eigen::Map<const Vector6>(impulse.data());
    archive.expect(body < scene_.mbd->bodies.size() && ahead_[body].allFinite(), "linear_implicit/ahead",
                   "no body is ahead of its liquid like that");
  }
  last_begin_ = -1;
}

}  // namespace tandem::launch
