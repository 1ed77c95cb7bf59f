// Checks of a particle participant: the loads that it gives.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "launch/conform/check.hpp"
#include "launch/conform/sample.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::LoadSet;

double sphere_mass(double density, double radius) {
  return density * 4 / 3 * std::numbers::pi * radius * radius * radius;
}
double mass_of(const Examination& e, std::size_t group) {
  const scene::Dem& dem = e.scene().dem.value();
  return sphere_mass(dem.materials[dem.particles[group].material.value].density,
                     dem.particles[group].radius_min);
}

// A load that is left out is zero.
BodyLoad load_or_zero(const LoadSet& loads, std::uint32_t body) {
  const BodyLoad* found = load_on(loads.bodies, body);
  return found ? *found : BodyLoad{};
}

// The scene's bodies at rest for so many windows; the last answer.
LoadSet rest(Session& session, const scene::Scene& scene, int count, double length = H) {
  LoadSet loads;
  const auto paths = paths_at_rest(scene);
  for (int i = 0; i < count; ++i) loads = session.advance(paths, length);
  return loads;
}

// Means over the last windows of spheres that have come to rest on the tray and on the ground.
struct Settled {
  Wrench tray, floor;
};
Settled settle(Examination& e) {
  const auto session = e.open();
  rest(*session, e.scene(), 400);
  constexpr int count = 50;
  Settled mean;
  for (int i = 0; i < count; ++i) {
    const LoadSet loads = rest(*session, e.scene(), 1);
    const BodyLoad tray = load_or_zero(loads, 1), floor = load_or_zero(loads, ground.value);
    mean.tray.force += (1.0 / count) * tray.mean.force;
    mean.tray.torque += (1.0 / count) * tray.mean.torque;
    mean.floor.force += (1.0 / count) * floor.mean.force;
    mean.floor.torque += (1.0 / count) * floor.mean.torque;
  }
  return mean;
}

void weight_on_body(Examination& e) {
  const Settled mean = settle(e);
  const Vec3d weight = mass_of(e, 0) * e.scene().gravity;
  e.compare("force on the tray", mean.tray.force, weight, 2e-3 * norm(weight), "N");
}

void torque_on_body(Examination& e) {
  const Settled mean = settle(e);
  const Vec3d weight = mass_of(e, 0) * e.scene().gravity, centre = e.scene().mbd->bodies[1].pose.p_WB;
  const Vec3d torque = cross(Vec3d{0.45, 0.12, 0.35} - centre, weight);
  e.compare("torque on the tray about its centre of mass", mean.tray.torque, torque, 5e-3 * norm(torque),
            "N m");
}

void load_on_ground(Examination& e) {
  const Settled mean = settle(e);
  const Vec3d weight = mass_of(e, 1) * e.scene().gravity;
  const Vec3d torque = cross(Vec3d{1, -0.5, 0}, weight);
  e.compare("force on the ground", mean.floor.force, weight, 2e-3 * norm(weight), "N");
  e.compare("torque on the ground about the world's origin", mean.floor.torque, torque, 5e-3 * norm(torque),
            "N m");
}

// Each window by itself: nothing of one window may be given in another one.
void momentum_balance(Examination& e) {
  const auto session = e.open();
  double worst = 0, scale = 0;
  for (int i = 0; i < 60; ++i) {
    const LoadSet loads = rest(*session, e.scene(), 1);
    const protocol::ParticleAccount& a = loads.account;
    Vec3d reaction;
    for (const BodyLoad& load : loads.bodies) reaction += -H * load.mean.force;
    const Vec3d change = a.momentum_end - a.momentum_begin + a.lost_momentum;
    worst = std::max(worst, norm(change - a.gravity_impulse - reaction));
    scale = std::max({scale, norm(change), norm(a.gravity_impulse), norm(reaction)});
  }
  e.compare("largest momentum of a window that no load or gravity gave", worst, 0, 1e-6 * scale, "N s");
}

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

void load_halves(Examination& e) {
  const auto whole = e.open(), halves = e.open();
  const auto total = [&](Session& session, int count, double length) {
    Vec3d impulse;
    for (int i = 0; i < count; ++i)
      for (const BodyLoad& load : rest(session, e.scene(), 1, length).bodies)
        impulse += length * load.mean.force;
    return impulse;
  };
  const Vec3d a = total(*whole, 20, H), b = total(*halves, 40, 0.5 * H);
  e.compare("impulse on all bodies in half windows", b, a, 2e-2 * norm(a) + 1e-9, "N s");
}

// Stiffness and damping along z against differences, each by a window of one micro step from the same state.
void linearise(Examination& e) {
  const auto session = e.open();
  const double dt = [&] {
    LoadSet loads = rest(*session, e.scene(), 400);
    return loads.account.micro_step;
  }();
  const std::uint32_t tray = 1;
  const protocol::TangentSet tangents = session->remote().linearise();
  const auto found = std::ranges::find(tangents.bodies, tray, &protocol::BodyTangent::body);
  if (found == tangents.bodies.end()) {
    e.expect(false, "a body on which a sphere lies has no tangent");
    return;
  }
  const protocol::BodyTangent tangent = *found;
  session->save();
  const auto loaded = [&](Vec3d displacement, Vec3d velocity) {
    session->restore();
    auto paths = paths_at_rest(e.scene());
    for (BodyMotion& path : paths)
      if (path.body == tray) {
        Pose pose = path.begin_pose;
        pose.p_WB += displacement;
        path = steady_path(tray, pose, {velocity, {}}, dt);
      }
    return load_or_zero(session->advance(paths, dt), tray).mean;
  };
  const Wrench base = loaded({}, {});
  const double step = 1e-7, speed = 1e-3;
  const Wrench moved_by = loaded({0, 0, step}, {}), moving = loaded({}, {0, 0, speed});
  const auto column = [](const std::array<double, 36>& m, int row) {
    return Vec3d{m[static_cast<std::size_t>(6 * row + 2)], m[static_cast<std::size_t>(6 * row + 8)],
                 m[static_cast<std::size_t>(6 * row + 14)]};
  };
  const auto compare = [&](const char* what, const std::array<double, 36>& matrix, const Wrench& changed,
                           double by, const std::string& unit) {
    const Vec3d force = (-1 / by) * (changed.force - base.force),
                torque = (-1 / by) * (changed.torque - base.torque);
    e.compare(std::string(what) + " of the force along z", column(matrix, 0), force, 5e-2 * norm(force),
              unit + "/m");
    e.compare(std::string(what) + " of the torque along z", column(matrix, 3), torque, 5e-2 * norm(torque),
              unit);
  };
  compare("stiffness", tangent.stiffness, moved_by, step, "N");
  compare("damping", tangent.damping, moving, speed, "N s");
}

void load_rollback(Examination& e) {
  const auto session = e.open();
  rest(*session, e.scene(), 20);
  session->save();
  std::vector<LoadSet> first;
  for (int i = 0; i < 5; ++i) first.push_back(rest(*session, e.scene(), 1));
  const protocol::ParticlesFrame seen = session->particles();
  const auto again = [&](const char* when) {
    session->restore();
    bool same = true;
    for (const LoadSet& loads : first) same = same && same_bits(rest(*session, e.scene(), 1), loads);
    e.expect(same && same_bits(session->particles(), seen),
             std::string("the same windows have other bits after ") + when);
  };
  again("restore");
  session->restore();
  rest(*session, e.scene(), 3, 2 * H);
  again("a second restore of one save, with other windows between");
  session->restore();
  rest(*session, e.scene(), 2);
  session->save();
  const LoadSet next = rest(*session, e.scene(), 1);
  session->restore();
  e.expect(same_bits(rest(*session, e.scene(), 1), next),
           "a second save did not take the place of the first");
}

}  // namespace

void add_load_checks(std::vector<Check>& table) {
  using namespace protocol;
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* scene,
                       bool any, void (*run)(Examination&)) {
    table.push_back({name, Side::dem, meaning, needs, nullptr, scene, any, run});
  };
  add("weight_on_body", "a sphere at rest loads a body by its weight, downwards", 0, "tray", false,
      weight_on_body);
  add("torque_on_body", "the torque of that load is about the body's centre of mass, in world axes", 0,
      "tray", false, torque_on_body);
  add("load_on_ground", "the ground has the load of its walls, its torque about the world's origin", 0,
      "tray", false, load_on_ground);
  add("momentum_balance",
      "in each window the momentum of the particles changes by gravity and by minus the loads", 0, "bed",
      true, momentum_balance);
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
  add("load_halves", "two windows of half the length give the same impulse as one", can_window_mean, "bed",
      true, load_halves);
  add("linearise", "stiffness and damping are minus the differences of the load by displacement and velocity",
      can_linearise | can_rollback, "tray", false, linearise);
  add("load_rollback",
      "the same windows after restore have the same bits, also after a second restore of one save",
      can_rollback, "bed", true, load_rollback);
}

}  // namespace tandem::conform
