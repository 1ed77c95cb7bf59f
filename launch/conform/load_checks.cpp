// Checks of a particle participant: loads at rest, balances, tangents and rollback.
#include <algorithm>
#include <cmath>

#include "launch/conform/load_run.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::LoadSet;

// Means over the last windows of spheres that have come to rest on the tray and on the ground.
struct Settled {
  Wrench tray, floor;
};
Settled settle(Examination& e) {
  const auto session = e.open();
  rest_windows(*session, e.scene(), 400);
  constexpr int count = 50;
  Settled mean;
  for (int i = 0; i < count; ++i) {
    const LoadSet loads = rest_windows(*session, e.scene(), 1);
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
    const LoadSet loads = rest_windows(*session, e.scene(), 1);
    const protocol::ParticleAccount& a = loads.account;
    Vec3d reaction;
    for (const BodyLoad& load : loads.bodies) reaction += -H * load.mean.force;
    const Vec3d change = a.momentum_end - a.momentum_begin + a.lost_momentum;
    worst = std::max(worst, norm(change - a.gravity_impulse - reaction));
    scale = std::max({scale, norm(change), norm(a.gravity_impulse), norm(reaction)});
  }
  e.compare("largest momentum of a window that no load or gravity gave", worst, 0, 1e-6 * scale, "N s");
}

void load_halves(Examination& e) {
  const auto whole = e.open(), halves = e.open();
  const auto total = [&](Session& session, int count, double length) {
    Vec3d impulse;
    for (int i = 0; i < count; ++i)
      for (const BodyLoad& load : rest_windows(session, e.scene(), 1, length).bodies)
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
    LoadSet loads = rest_windows(*session, e.scene(), 400);
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
  rest_windows(*session, e.scene(), 20);
  session->save();
  std::vector<LoadSet> first;
  for (int i = 0; i < 5; ++i) first.push_back(rest_windows(*session, e.scene(), 1));
  const protocol::ParticlesFrame seen = session->particles();
  const auto again = [&](const char* when) {
    session->restore();
    bool same = true;
    for (const LoadSet& loads : first) same = same && same_bits(rest_windows(*session, e.scene(), 1), loads);
    e.expect(same && same_bits(session->particles(), seen),
             std::string("the same windows have other bits after ") + when);
  };
  again("restore");
  session->restore();
  rest_windows(*session, e.scene(), 3, 2 * H);
  again("a second restore of one save, with other windows between");
  session->restore();
  rest_windows(*session, e.scene(), 2);
  session->save();
  const LoadSet next = rest_windows(*session, e.scene(), 1);
  session->restore();
  e.expect(same_bits(rest_windows(*session, e.scene(), 1), next),
           "a second save did not take the place of the first");
}

}  // namespace

void add_load_checks(std::vector<Check>& table) {
  using namespace protocol;
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* scene,
                       bool any, void (*run)(Examination&), const char* of_liquid = nullptr) {
    table.push_back({name, meaning, needs, nullptr, scene, any, run, false, of_liquid});
  };
  add("weight_on_body", "a sphere at rest loads a body by its weight, downwards", 0, "tray", false,
      weight_on_body);
  add("torque_on_body", "the torque of that load is about the body's centre of mass, in world axes", 0,
      "tray", false, torque_on_body);
  add("load_on_ground", "the ground has the load of its walls, its torque about the world's origin", 0,
      "tray", false, load_on_ground);
  add("momentum_balance",
      "in each window the momentum of the particles changes by gravity and by minus the loads", 0, "bed",
      true, momentum_balance, "basin");
  add("load_halves", "two windows of half the length give the same impulse as one", can_window_mean, "bed",
      true, load_halves, "basin");
  add("linearise", "stiffness and damping are minus the differences of the load by displacement and velocity",
      can_linearise | can_rollback, "tray", false, linearise);
  add("load_rollback",
      "the same windows after restore have the same bits, also after a second restore of one save",
      can_rollback, "bed", true, load_rollback, "basin");
}

}  // namespace tandem::conform
