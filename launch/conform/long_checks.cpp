// Checks of --long: a participant must not change while it runs. Figures are those of blocks of windows, so
// that the one that fails has the time at which the fault began.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "launch/conform/load_run.hpp"
#include "launch/conform/motion_run.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::LoadSet;
using protocol::MotionSet;

constexpr int block_windows = 100;  // windows

int blocks_of(const Examination& e) {
  return static_cast<int>(std::ceil(e.limits().long_run / (block_windows * H) * (1 - 1e-12)));
}
std::string when(const Session& session) {
  return fmt::format(" in the {:.3g} s before t = {:.3g} s", block_windows * H, session.time());
}

// Loads that change their sign from block to block, so that speeds stay as they are in a short run.
void long_motion(Examination& e) {
  const auto session = e.open();
  const auto boundary = session->configured().boundary;
  std::map<std::uint32_t, BodyMotion> last;
  for (const BodyMotion& motion : boundary) last[motion.body] = motion;
  double jump = 0;
  for (int b = 0; b < blocks_of(e); ++b) {
    const std::vector<BodyLoad> loads = sample_loads(e.scene(), boundary, b % 2 == 0 ? 1 : -1);
    const auto begin = last;
    for (int i = 0; i < block_windows; ++i) {
      const MotionSet motion = session->advance(loads, H);
      for (const BodyMotion& m : motion.bodies) {
        jump = std::max({jump, norm(m.begin_pose.p_WB - last[m.body].end_pose.p_WB),
                         norm(m.begin_twist.v_WB - last[m.body].end_twist.v_WB),
                         norm(m.begin_twist.w_WB - last[m.body].end_twist.w_WB)});
        last[m.body] = m;
      }
    }
    const double t = block_windows * H;
    for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
      const Wrench& load = load_on(loads, index)->mean;
      const Twist &from = begin.at(index).end_twist, &to = last[index].end_twist;
      const Quat &q_from = begin.at(index).end_pose.q_WB, &q_to = last[index].end_pose.q_WB;
      const Vec3d impulse = t * (load.force + body.mass * e.scene().gravity), turn = t * load.torque;
      e.compare("momentum got by " + body.name + when(*session), body.mass * (to.v_WB - from.v_WB), impulse,
                velocity_share * norm(impulse), "N s");
      const Vec3d spin = launch::inertia_times(body, q_to, to.w_WB);
      e.compare("angular momentum got by " + body.name + when(*session),
                spin - launch::inertia_times(body, q_from, from.w_WB), turn,
                position_share * (norm(turn) + norm(spin)), "N m s");
    });
    for (const protocol::BodyState& state : session->bodies().bodies)
      if (last.contains(state.body))
        e.compare("position in the frame against the motion" + when(*session), state.pose.p_WB,
                  last[state.body].end_pose.p_WB, 1e-6, "m");
  }
  e.compare("largest jump between windows, of position [m], velocity [m/s] or angular velocity [rad/s]", jump,
            0, 1e-6, "");
}

// A sphere rests on the tray and another one on the ground.
void long_load(Examination& e) {
  const auto session = e.open();
  const Vec3d weight = mass_of(e, 0) * e.scene().gravity, ground_weight = mass_of(e, 1) * e.scene().gravity;
  const Vec3d torque = cross(Vec3d{0.45, 0.12, 0.35} - e.scene().mbd->bodies[1].pose.p_WB, weight);
  Vec3d momentum;
  bool begun = false;
  double error = 0;
  for (int b = 0; b < blocks_of(e); ++b) {
    Wrench tray, floor;
    for (int i = 0; i < block_windows; ++i) {
      const LoadSet loads = rest_windows(*session, e.scene(), 1);
      const protocol::ParticleAccount& a = loads.account;
      Vec3d given = a.gravity_impulse;
      for (const BodyLoad& load : loads.bodies) given += -H * load.mean.force;
      const Vec3d change = a.momentum_end - (begun ? momentum : a.momentum_begin);
      error = std::max(error, norm(change - given));
      momentum = a.momentum_end;
      begun = true;
      const BodyLoad on_tray = load_or_zero(loads, 1), on_floor = load_or_zero(loads, ground.value);
      tray.force += (1.0 / block_windows) * on_tray.mean.force;
      tray.torque += (1.0 / block_windows) * on_tray.mean.torque;
      floor.force += (1.0 / block_windows) * on_floor.mean.force;
    }
    const protocol::ParticlesFrame frame = session->particles();
    e.compare("number of spheres in the frame" + when(*session), static_cast<double>(frame.id.size()), 2, 0,
              "");
    if (b < 4) continue;  // the spheres come to rest
    e.compare("force on the tray" + when(*session), tray.force, weight, 2e-3 * norm(weight), "N");
    e.compare("torque on the tray" + when(*session), tray.torque, torque, 5e-3 * norm(torque), "N m");
    e.compare("force on the ground" + when(*session), floor.force, ground_weight, 2e-3 * norm(ground_weight),
              "N");
  }
  e.compare("largest momentum of a window that no load or gravity gave", error, 0,
            1e-6 * H * (norm(weight) + norm(ground_weight)), "N s");
}

}  // namespace

void add_long_checks(std::vector<Check>& table) {
  table.push_back({"long_motion",
                   "with --long: free bodies move as load and gravity require, to the end of a long run", 0,
                   "free_bodies", nullptr, false, long_motion, true});
  table.push_back(
      {"long_load",
       "with --long: spheres at rest load body and ground by their weight, to the end of a long run", 0,
       nullptr, "tray", false, long_load, true});
}

}  // namespace tandem::conform
