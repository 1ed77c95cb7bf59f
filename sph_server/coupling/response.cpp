#include "sph_server/coupling/response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/log.hpp"
#include "common/scene/freedoms.hpp"

namespace tandem::sph {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Direction = std::array<double, 6>;  // velocity, angular velocity

// A step of the velocity of this share of the speed of sound moves a wall by some thousandths of a spacing.
constexpr double share_of_sound = 1e-3;
// Directions that meet less than this share of the largest resistance meet none.
constexpr double negligible = 1e-3;

// y of (1 - exp(-y)) / y = q, for q in (0, 1): decreasing in y, found by bisection.
double relaxation_of(double q) {
  double low = 1e-3, high = 1e3;
  if (q >= -std::expm1(-low) / low) return low;
  if (q <= -std::expm1(-high) / high) return high;
  while (high - low > 1e-9 * high) {
    const double y = 0.5 * (low + high);
    (-std::expm1(-y) / y > q ? low : high) = y;
  }
  return low;
}

Mat3d product(const Mat3d& a, const Mat3d& b) {
  Mat3d c;
  for (int i = 0; i < 3; ++i) c.row[i] = b.transpose_times(a.row[i]);
  return c;
}

void put(const Matrix6& from, std::array<double, 36>& to) {
  Eigen::Map<Matrix6>(to.data()) = from;
}

// The loads on `body` of each step, where it starts to move faster by `faster` along `direction`.
class Probe {
 public:
  Probe(LiquidEngine& engine, const LiquidState& start, const std::vector<particles::BodyPose>& poses,
        const std::vector<BodyId>& body_of, double dt, int steps)
      : engine_(engine), start_(start), poses_(poses), body_of_(body_of), dt_(dt), steps_(steps) {}

  std::vector<Vector6> impulses(BodyId body, const Direction& direction, double faster) const {
    engine_.set_state(start_, poses_);
    std::vector<Vector6> sums;
    Vector6 sum = Vector6::Zero();
    std::vector<particles::BodyPose> now = poses_;
    for (int k = 1; k <= steps_; ++k) {
      for (std::size_t b = 0; b < now.size(); ++b) {
        if (body_of_[b] == ground) continue;
        const double more = body_of_[b] == body ? faster : 0;
        const auto& d = direction;
        const particles::BodyPose& from = poses_[b];
        const Vec3d v = from.v + more * Vec3d{d[0], d[1], d[2]}, w = from.w + more * Vec3d{d[3], d[4], d[5]};
        now[b] = {from.p + (k * dt_) * v, product(exp((k * dt_) * w).matrix(), from.R), v, w};
      }
      engine_.step(dt_, now);
      for (std::size_t b = 0; b < now.size(); ++b) {
        if (body_of_[b] != body) continue;
        const Wrench& load = engine_.step_loads()[b];
        sum += dt_ * Vector6{load.force.x,  load.force.y,  load.force.z,
                             load.torque.x, load.torque.y, load.torque.z};
      }
      sums.push_back(sum);
    }
    return sums;
  }

 private:
  LiquidEngine& engine_;
  const LiquidState& start_;
  const std::vector<particles::BodyPose>& poses_;
  const std::vector<BodyId>& body_of_;
  double dt_;
  int steps_;
};

std::vector<Direction> directions_of(const scene::Freedom& freedom) {
  if (freedom.fixed) return {};
  if (freedom.single) return {*freedom.single};
  std::vector<Direction> all(6, Direction{});
  for (std::size_t i = 0; i < 6; ++i) all[i][i] = 1;
  return all;
}

double gyration_of(const scene::Body& body) {
  return std::sqrt((body.inertia[0] + body.inertia[1] + body.inertia[2]) / (2 * body.mass));
}

StepResponse step_response(const Probe& probe, BodyId body, const std::vector<Direction>& directions,
                           double speed, double gyration, double dt) {
  StepResponse response{dt, {}};
  const std::vector<Vector6> base = probe.impulses(body, {}, 0);
  response.impulse.resize(base.size());
  for (const Direction& direction : directions) {
    const Eigen::Map<const Vector6> f(direction.data());
    const double faster = speed / std::hypot(f.head<3>().norm(), gyration * f.tail<3>().norm());
    const std::vector<Vector6> moved = probe.impulses(body, direction, faster);
    for (std::size_t k = 0; k < base.size(); ++k) {
      Eigen::Map<Matrix6> sum(response.impulse[k].data());
      const Vector6 resistance = (base[k] - moved[k]) / faster;
      // A body with one freedom only meets what resists along it.
      if (directions.size() == 1)
        sum += f.dot(resistance) / std::pow(f.squaredNorm(), 2) * f * f.transpose();
      else
        sum += resistance * f.transpose();
    }
  }
  return response;
}

}  // namespace

protocol::BodyResponse fitted(const StepResponse& measured, double gyration) {
  protocol::BodyResponse response;
  const double dt = measured.dt, last = static_cast<double>(measured.impulse.size()) * dt;
  Vector6 scale;  // lengths in place of angles
  scale << 1, 1, 1, 1 / gyration, 1 / gyration, 1 / gyration;
  std::vector<Matrix6> impulse{Matrix6::Zero()};
  for (const std::array<double, 36>& raw : measured.impulse) {
    const Matrix6 m = scale.asDiagonal() * Eigen::Map<const Matrix6>(raw.data()) * scale.asDiagonal();
    impulse.push_back(0.5 * (m + m.transpose()));
  }
  // The load is largest before anything that the body has set in motion comes back to it.
  std::size_t at = 1;
  for (std::size_t k = 1; k < impulse.size(); ++k)
    if ((impulse[k] - impulse[k - 1]).trace() > (impulse[at] - impulse[at - 1]).trace()) at = k;
  const Matrix6 radiation = (impulse[at] - impulse[at - 1]) / dt;
  const Eigen::SelfAdjointEigenSolver<Matrix6> modes(radiation);
  const double largest = modes.eigenvalues().maxCoeff();
  if (!(largest > 0)) return response;
  const double middle = (static_cast<double>(at) - 0.5) * dt,
               until = 0.5 * (impulse[at] + impulse[at - 1]).trace() / radiation.trace();
  response.delay = std::clamp(middle - until, 0.0, 0.9 * last);
  const double time = last - response.delay;
  Matrix6 R = Matrix6::Zero(), added = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) {
    const double r = modes.eigenvalues()[i];
    if (r < negligible * largest) continue;
    const Vector6 q = modes.eigenvectors().col(i);
    R += r * q * q.transpose();
    added += r * time / relaxation_of(q.dot(impulse.back() * q) / (r * time)) * q * q.transpose();
  }
  const Vector6 back = scale.cwiseInverse();
  put(back.asDiagonal() * R * back.asDiagonal(), response.radiation);
  put(back.asDiagonal() * added * back.asDiagonal(), response.added_mass);
  return response;
}

std::vector<protocol::BodyResponse> measure_responses(LiquidEngine& engine, const LiquidState& start,
                                                      const std::vector<particles::BodyPose>& poses,
                                                      const std::vector<BodyId>& body_of,
                                                      const scene::Scene& scene, double sound_speed,
                                                      double dt, int steps) {
  std::vector<protocol::BodyResponse> responses;
  if (!scene.mbd || start.size() == 0) return responses;
  const std::vector<scene::Freedom> freedoms = scene::freedoms_of(*scene.mbd);
  std::vector<BodyId> bodies;
  for (const BodyId body : body_of)
    if (body != ground && std::ranges::find(bodies, body) == bodies.end()) bodies.push_back(body);
  std::ranges::sort(bodies, {}, &BodyId::value);
  const Probe probe(engine, start, poses, body_of, dt, steps);
  const double speed = share_of_sound * sound_speed;
  for (const BodyId body : bodies) {
    const std::vector<Direction> directions = directions_of(freedoms[body.value]);
    if (directions.empty()) continue;
    const double gyration = gyration_of(scene.mbd->bodies[body.value]);
    protocol::BodyResponse response =
        fitted(step_response(probe, body, directions, speed, gyration, dt), gyration);
    if (!(*std::ranges::max_element(response.radiation) > 0)) continue;
    response.body = body.value;
    responses.push_back(response);
  }
  engine.set_state(start, poses);
  return responses;
}

}  // namespace tandem::sph
