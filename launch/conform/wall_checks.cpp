// Checks of a particle participant: loads of a sphere that a moving wall hits.
#include <algorithm>
#include <cmath>

#include "launch/conform/load_run.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::LoadSet;

// The piston moves at a constant velocity from the begin of the run on.
struct Pushed {
  std::vector<LoadSet> loads;
  Vec3d velocity, impulse;  // of the piston; given to the sphere
  Vec3d momentum;           // of the sphere at the end
  double work = 0;          // of the sphere on the piston
};
Pushed push(Examination& e, double length, int count) {
  Pushed run;
  run.velocity = {0.5, 0, 0};
  const auto session = e.open();
  const Pose start = e.scene().mbd->bodies[0].pose;
  const Twist twist{run.velocity, {}};
  for (int i = 0; i < count; ++i) {
    const LoadSet loads = session->advance(
        std::vector{steady_path(0, moved(start, twist, session->time()), twist, length)}, length);
    const BodyLoad load = load_or_zero(loads, 0);
    run.impulse += -length * load.mean.force;
    run.work += load.work;
    run.loads.push_back(loads);
  }
  run.momentum = run.loads.back().account.momentum_end;
  return run;
}

void same_window(Examination& e) {
  const Pushed run = push(e, H, 1);
  // Until the begin of the contact the path is known; a sphere that only met the wall at the end of the
  // window would give nothing.
  const double force = -load_or_zero(run.loads[0], 0).mean.force.x;
  e.expect(force > 0,
           "the wall reaches the sphere after 0.4 ms of a window of 1 ms, but the load of this window is "
           "zero: walls "
           "follow their path inside the window");
  // Against the same 1 ms in ten windows.
  const Pushed fine = push(e, 0.1 * H, 10);
  e.compare("impulse of the window of the first contact", run.impulse, fine.impulse,
            2e-2 * norm(fine.impulse), "N s");
}

void moving_wall(Examination& e) {
  const Pushed run = push(e, H, 20);
  const Vec3d expected = 2 * mass_of(e, 0) * run.velocity;
  e.compare("momentum that the piston gives", run.impulse, expected, 1e-2 * norm(expected), "N s");
}

void turning_wall(Examination& e) {
  const auto session = e.open();
  const Pose start = e.scene().mbd->bodies[0].pose;
  const Twist twist{{}, {0, 0, 5}};
  Vec3d impulse, angular;
  double work = 0;
  for (int i = 0; i < 20; ++i) {
    const BodyLoad load = load_or_zero(
        session->advance(std::vector{steady_path(0, moved(start, twist, session->time()), twist, H)}, H), 0);
    impulse += -H * load.mean.force;
    angular += -H * load.mean.torque;
    work += load.work;
  }
  // In contact for some 2 ms, in which the paddle turns by a hundredth.
  const double expected = 2 * mass_of(e, 0) * 5 * 0.3;
  e.compare("momentum that the paddle gives", norm(impulse), expected, 3e-2 * expected, "N s");
  e.compare("angular momentum that the paddle gives", angular, {0, 0, 0.3 * expected}, 3e-2 * 0.3 * expected,
            "N m s");
  const double along = -dot(angular, twist.w_WB);
  e.compare("work on a paddle of constant angular velocity", work, along, 1e-6 * std::abs(along), "J");
}

void load_work(Examination& e) {
  const Pushed run = push(e, H, 20);
  double along = 0;
  for (const LoadSet& loads : run.loads) along += H * dot(load_or_zero(loads, 0).mean.force, run.velocity);
  e.compare("work on a piston of constant velocity", run.work, along, 1e-6 * std::abs(along), "J");
  const double given = 2 * mass_of(e, 0) * norm2(run.velocity);
  e.compare("energy that the piston gives", -run.work, given, 2e-2 * given, "J");
}

void window_mean(Examination& e) {
  const Pushed whole = push(e, H, 5), halves = push(e, 0.5 * H, 10);
  for (std::size_t i = 0; i < 5; ++i) {
    const Vec3d a = load_or_zero(whole.loads[i], 0).mean.force;
    const Vec3d b = 0.5 * (load_or_zero(halves.loads[2 * i], 0).mean.force +
                           load_or_zero(halves.loads[2 * i + 1], 0).mean.force);
    e.compare("mean of window " + std::to_string(i) + " against its halves", a, b, 2e-2 * norm(b) + 1e-3,
              "N");
  }
}

void end_load(Examination& e) {
  const Pushed run = push(e, H, 2);
  // The same instant as the mean of a short window at the end.
  const auto session = e.open();
  const Pose start = e.scene().mbd->bodies[0].pose;
  const Twist twist{run.velocity, {}};
  LoadSet loads;
  for (const double length : {H, 0.98 * H, 0.02 * H})
    loads = session->advance(std::vector{steady_path(0, moved(start, twist, session->time()), twist, length)},
                             length);
  const Vec3d expected = load_or_zero(loads, 0).mean.force;
  e.compare("load at the end of a window", load_or_zero(run.loads.back(), 0).end.force, expected,
            5e-2 * norm(expected), "N");
}

void load_moment(Examination& e) {
  const Pushed run = push(e, H, 2);
  const int parts = 20;
  const Pushed fine = push(e, H / parts, 2 * parts);
  Vec3d expected;
  for (int i = 0; i < parts; ++i)
    expected += (H / parts) * ((i + 0.5) / parts - 0.5) *
                load_or_zero(fine.loads[static_cast<std::size_t>(parts + i)], 0).mean.force;
  e.compare("first moment of the load of a window", load_or_zero(run.loads.back(), 0).first_moment.force,
            expected, 3e-2 * norm(expected), "N s");
}

}  // namespace

void add_wall_checks(std::vector<Check>& table) {
  using namespace protocol;
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* scene,
                       bool any, void (*run)(Examination&)) {
    table.push_back({name, meaning, needs, nullptr, scene, any, run});
  };
  add("same_window", "a wall that reaches a sphere inside a window loads it in this window", can_interpolate,
      "piston", false, same_window);
  add("moving_wall", "a sphere leaves a moving wall with twice its velocity", can_interpolate, "piston",
      false, moving_wall);
  add("turning_wall", "a turning wall has the velocity of the place of contact", can_interpolate, "paddle",
      false, turning_wall);
  add("load_work", "the work of a load on a body of constant velocity is mean force times path", 0, "piston",
      false, load_work);
  add("window_mean", "the load of a window is the mean of those of its halves", can_window_mean, "piston",
      false, window_mean);
  add("end_load", "the load at the end is the mean of a short window there", 0, "piston", false, end_load);
  add("load_moment", "the first moment is that of the loads of short windows", can_window_mean, "piston",
      false, load_moment);
}

}  // namespace tandem::conform
