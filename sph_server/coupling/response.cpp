#include "sph_server/coupling/response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "common/log.hpp"
#include "common/scene/freedoms.hpp"

namespace tandem::sph {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Direction = std::array<double, 6>;  // velocity, angular velocity

// A step of the velocity of this share of the speed of sound moves a wall by some thousandths of a spacing.
constexpr double share_of_sound = 1e-3;

Mat3d product(const Mat3d& a, const Mat3d& b) {
  Mat3d c;
  for (int i = 0; i < 3; ++i) c.row[i] = b.transpose_times(a.row[i]);
  return c;
}

using Impulses = std::vector<Vector6>;  // of a body, after each step

// The motion of the liquid where a body starts to move faster.
class Push {
 public:
  Push(LiquidEngine& engine, const LiquidState& start, const std::vector<particles::BodyPose>& poses,
       const std::vector<BodyId>& body_of, double dt, int steps)
      : engine_(engine), start_(start), poses_(poses), body_of_(body_of), dt_(dt), steps_(steps) {}

  // Of all bodies by their number, where none is faster: the bodies share this motion.
  std::map<std::uint32_t, Impulses> of_all() const { return impulses(ground, {}, 0); }
  // Of `body`, where it is faster by `faster` along `direction`.
  Impulses of(BodyId body, const Direction& direction, double faster) const {
    return impulses(body, direction, faster).at(body.value);
  }

 private:
  std::map<std::uint32_t, Impulses> impulses(BodyId body, const Direction& direction, double faster) const {
    engine_.set_state(start_, poses_);
    std::map<std::uint32_t, Impulses> sums;
    for (const BodyId b : body_of_)
      if (b != ground) sums[b.value].assign(static_cast<std::size_t>(steps_), Vector6::Zero());
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
      const auto step = static_cast<std::size_t>(k - 1);
      for (auto& [b, sum] : sums)
        if (k > 1) sum[step] = sum[step - 1];
      for (std::size_t b = 0; b < now.size(); ++b) {
        if (body_of_[b] == ground) continue;
        const Wrench& load = engine_.step_loads()[b];
        sums[body_of_[b].value][step] += dt_ * Vector6{load.force.x,  load.force.y,  load.force.z,
                                                       load.torque.x, load.torque.y, load.torque.z};
      }
    }
    return sums;
  }

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

// No particle was near the body.
bool is_dry(const Impulses& base) {
  return std::ranges::all_of(base, [](const Vector6& impulse) { return impulse.isZero(0); });
}

double gyration_of(const scene::Body& body) {
  return std::sqrt((body.inertia[0] + body.inertia[1] + body.inertia[2]) / (2 * body.mass));
}

// The impulse that resists after each step, by rows.
std::vector<std::array<double, 36>> step_response(const Push& push, BodyId body, const Impulses& base,
                                                  const std::vector<Direction>& directions, double speed,
                                                  double gyration) {
  std::vector<std::array<double, 36>> response(base.size());
  for (const Direction& direction : directions) {
    const Eigen::Map<const Vector6> f(direction.data());
    const double faster = speed / std::hypot(f.head<3>().norm(), gyration * f.tail<3>().norm());
    const Impulses moved = push.of(body, direction, faster);
    for (std::size_t k = 0; k < base.size(); ++k) {
      Eigen::Map<Matrix6> sum(response[k].data());
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
  std::size_t pushes = 0;
  for (const BodyId body : bodies) pushes += directions_of(freedoms[body.value]).size();
  if (pushes == 0) return responses;
  log::info("measuring how the liquid resists {} bodies: at most {} steps", bodies.size(),
            (pushes + 1) * static_cast<std::size_t>(steps));
  const Push push(engine, start, poses, body_of, dt, steps);
  const std::map<std::uint32_t, Impulses> base = push.of_all();
  const double speed = share_of_sound * sound_speed;
  for (const BodyId body : bodies) {
    std::vector<Direction> directions = directions_of(freedoms[body.value]);
    if (directions.empty()) continue;
    if (is_dry(base.at(body.value))) directions.clear();  // nothing resists
    const double gyration = gyration_of(scene.mbd->bodies[body.value]);
    double time = 0;
    for (const std::array<double, 36>& impulse :
         step_response(push, body, base.at(body.value), directions, speed, gyration))
      responses.push_back({.body = body.value, .time = time += dt, .impulse = impulse});
  }
  engine.set_state(start, poses);
  return responses;
}

void turn(const Mat3d& now, const Mat3d& before, protocol::BodyResponse& response) {
  if (now == before) return;
  Eigen::Matrix3d to, from;
  for (int i = 0; i < 3; ++i) {
    to.row(i) << now.row[i].x, now.row[i].y, now.row[i].z;
    from.row(i) << before.row[i].x, before.row[i].y, before.row[i].z;
  }
  Matrix6 both = Matrix6::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = to * from.transpose();
  const Matrix6 turned = both * Eigen::Map<const Matrix6>(response.impulse.data()) * both.transpose();
  Eigen::Map<Matrix6>(response.impulse.data()) = turned;
}

}  // namespace tandem::sph
