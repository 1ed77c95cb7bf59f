// Checks of a multibody participant on free bodies: closed forms, and balances against what it was given.
#include <algorithm>
#include <cmath>

#include "coordinator/watch/energy_watch.hpp"
#include "coordinator/watch/motion_watch.hpp"
#include "launch/conform/motion_run.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::MotionSet;

void free_fall(Examination& e) {
  const MotionRun run = run_under(e, 0, run_windows);
  const double t = run.time();
  const Vec3d g = e.scene().gravity;
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion& end = run.last(index);
    e.compare("velocity of " + body.name, end.end_twist.v_WB, body.twist.v_WB + t * g,
              velocity_share * t * norm(g), "m/s");
    e.compare("position of " + body.name, end.end_pose.p_WB,
              body.pose.p_WB + t * body.twist.v_WB + (0.5 * t * t) * g,
              position_share * 0.5 * t * t * norm(g), "m");
  });
}

void force_impulse(Examination& e) {
  const MotionRun run = run_under(e, 1, run_windows);
  const double t = run.time();
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const Vec3d impulse = t * (load_on(run.loads, index)->mean.force + body.mass * e.scene().gravity);
    e.compare("momentum got by " + body.name, body.mass * (run.last(index).end_twist.v_WB - body.twist.v_WB),
              impulse, velocity_share * norm(impulse), "N s");
  });
}

void force_position(Examination& e) {
  const MotionRun run = run_under(e, 1, run_windows);
  const double t = run.time();
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const Vec3d a = (1 / body.mass) * load_on(run.loads, index)->mean.force;
    const Vec3d free = body.pose.p_WB + t * body.twist.v_WB + (0.5 * t * t) * e.scene().gravity;
    e.compare("displacement of " + body.name + " by the force", run.last(index).end_pose.p_WB - free,
              (0.5 * t * t) * a, position_share * 0.5 * t * t * norm(a + e.scene().gravity), "m");
  });
}

void central_force(Examination& e) {
  const auto session = e.open();
  std::vector<BodyLoad> loads = sample_loads(e.scene(), session->configured().boundary);
  for (BodyLoad& load : loads) load.mean.torque = load.end.torque = {};
  MotionSet motion;
  for (int i = 0; i < run_windows; ++i) motion = session->advance(loads, H);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    if (norm(body.twist.w_WB) > 0) return;
    e.compare("angular velocity of " + body.name, motion_of(motion, index).end_twist.w_WB, {}, 1e-6, "rad/s");
  });
}

void torque_impulse(Examination& e) {
  const MotionRun run = run_under(e, 1, run_windows);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion& end = run.last(index);
    const Vec3d impulse = run.time() * load_on(run.loads, index)->mean.torque;
    e.compare("angular momentum got by " + body.name,
              launch::angular_momentum(body, end.end_pose, end.end_twist) -
                  launch::angular_momentum(body, body.pose, body.twist),
              impulse, position_share * norm(impulse), "N m s");
  });
}

// The rotation of each window against the mean of the angular velocities at both of its ends.
void rotation(Examination& e) {
  const MotionRun run = run_under(e, 1, run_windows);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    Vec3d turned, expected;
    for (const MotionSet& motion : run.motions) {
      const BodyMotion& m = motion_of(motion, index);
      turned += rotation_vector(m.end_pose.q_WB * m.begin_pose.q_WB.conjugate());
      expected += (0.5 * H) * (m.begin_twist.w_WB + m.end_twist.w_WB);
    }
    e.compare("rotation of " + body.name, turned, expected, position_share * norm(expected), "rad");
  });
}

void applied_impulse(Examination& e) {
  const MotionRun run = run_under(e, 1, 5);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const Wrench& load = load_on(run.loads, index)->mean;
    for (const MotionSet& motion : {run.motions.front(), run.motions.back()}) {
      const Wrench& applied = motion_of(motion, index).applied_impulse;
      e.compare("impulse on " + body.name, applied.force, H * load.force, rounding * H * norm(load.force),
                "N s");
      e.compare("angular impulse on " + body.name, applied.torque, H * load.torque,
                rounding * H * norm(load.torque), "N m s");
    }
  });
}

void applied_work(Examination& e) {
  const MotionRun run = run_under(e, 1, run_windows);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    double work = 0;
    for (const MotionSet& motion : run.motions) work += motion_of(motion, index).applied_work;
    const BodyMotion& end = run.last(index);
    const double gained = launch::kinetic_energy(body, end.end_pose, end.end_twist) -
                          launch::kinetic_energy(body, body.pose, body.twist) -
                          body.mass * dot(e.scene().gravity, end.end_pose.p_WB - body.pose.p_WB);
    e.compare("work on " + body.name, work, gained, position_share * std::abs(gained), "J");
  });
}

void motion_chain(Examination& e) {
  const MotionRun run = run_under(e, 1, 10);
  launch::MotionWatch watch(e.scene());
  for (const MotionSet& motion : run.motions) watch.record(motion);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const auto jumps = watch.jumps().find(index);
    e.compare("largest jump of " + body.name + ", of its size",
              jumps == watch.jumps().end() ? 0 : jumps->second.largest.share, 0, rounding, "");
  });
}

// The accelerations at both ends of a later window, against the load and gravity.
void acceleration(Examination& e) {
  const MotionRun run = run_under(e, 1, 5);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion& m = run.last(index);
    const Wrench& load = load_on(run.loads, index)->mean;
    const Vec3d a = e.scene().gravity + (1 / body.mass) * load.force;
    e.compare("acceleration of " + body.name + " at the begin", m.begin_a, a, position_share * norm(a),
              "m/s2");
    e.compare("acceleration of " + body.name + " at the end", m.end_a, a, position_share * norm(a), "m/s2");
    for (const bool at_end : {false, true}) {
      const Quat& q = at_end ? m.end_pose.q_WB : m.begin_pose.q_WB;
      const Vec3d w = at_end ? m.end_twist.w_WB : m.begin_twist.w_WB,
                  alpha = at_end ? m.end_alpha : m.begin_alpha;
      const Vec3d gyroscopic = cross(w, launch::inertia_times(body, q, w));
      e.compare("rate of angular momentum of " + body.name + (at_end ? " at the end" : " at the begin"),
                launch::inertia_times(body, q, alpha) + gyroscopic, load.torque,
                2 * position_share * (norm(load.torque) + norm(gyroscopic)), "N m");
    }
  });
}

void window_lengths(Examination& e) {
  const auto session = e.open();
  const Vec3d g = e.scene().gravity;
  MotionSet motion;
  for (int i = 0; i < 20; ++i)
    for (const double length : {0.7e-3, 1.3e-3, 0.4e-3})
      motion = session->advance(std::vector<BodyLoad>{}, length);
  const double t = session->time();
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    e.compare("velocity of " + body.name, motion_of(motion, index).end_twist.v_WB, body.twist.v_WB + t * g,
              velocity_share * t * norm(g), "m/s");
  });
}

// What a window of H and two of H/2 make of the same loads.
void window_halves(Examination& e) {
  const MotionRun whole = run_under(e, 1, 10), halves = run_under(e, 1, 20, 0.5 * H);
  const double t = whole.time();
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion &begin = whole.first(index), &a = whole.last(index), &b = halves.last(index);
    // By what the bodies are accelerated; a body at rest stays at rest.
    const double speed = norm(a.end_twist.v_WB - begin.begin_twist.v_WB) + 1e-6 * norm(e.scene().gravity) * t;
    const double spin = norm(a.end_twist.w_WB - begin.begin_twist.w_WB) + 1e-6;
    e.compare("change of velocity of " + body.name + " in half windows",
              b.end_twist.v_WB - begin.begin_twist.v_WB, a.end_twist.v_WB - begin.begin_twist.v_WB,
              2 * position_share * speed, "m/s");
    e.compare("change of angular velocity of " + body.name + " in half windows",
              b.end_twist.w_WB - begin.begin_twist.w_WB, a.end_twist.w_WB - begin.begin_twist.w_WB,
              2 * position_share * spin, "rad/s");
    e.compare("position of " + body.name + " in half windows", b.end_pose.p_WB, a.end_pose.p_WB,
              2 * position_share * speed * t, "m");
  });
}

// The frame of the results against the last motion.
void observe_bodies(Examination& e) {
  const MotionRun run = run_under(e, 1, 5);
  const protocol::BodiesFrame frame = run.session->bodies();
  e.compare("number of bodies", static_cast<double>(frame.bodies.size()),
            static_cast<double>(e.scene().mbd->bodies.size()), 0, "");
  e.compare("number of joints", static_cast<double>(frame.joints.size()),
            static_cast<double>(e.scene().mbd->joints.size()), 0, "");
  launch::MotionWatch watch(e.scene());
  watch.record(run.motions.back());
  watch.observe(frame.time, frame.bodies);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const auto found = watch.false_frames().find(index);
    e.compare("difference of " + body.name + " from the motion, of its size",
              found == watch.false_frames().end() ? 0 : found->second.share, 0, rounding, "");
  });
}

void energy(Examination& e) {
  const auto session = e.open();
  const auto loads = sample_loads(e.scene(), session->configured().boundary);
  launch::EnergyWatch watch(e.scene());
  watch.observe(session->bodies());
  for (int i = 0; i < run_windows; ++i) session->advance(loads, H);
  watch.observe(session->bodies());
  const auto& found = watch.largest();
  if (!found) return e.expect(false, "a frame lacks a body");
  e.compare("change of the energy", found->reported, found->computed,
            position_share * std::abs(found->computed), "J");
}

}  // namespace

void add_motion_checks(std::vector<Check>& table) {
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, bool any,
                       void (*run)(Examination&)) {
    table.push_back({name, meaning, needs, "free_bodies", nullptr, any, run});
  };
  add("free_fall", "without loads, velocities are g t and positions g t2/2 further", 0, false, free_fall);
  add("force_impulse", "the momentum that a body gets is the impulse of load and gravity", 0, false,
      force_impulse);
  add("force_position", "a constant force moves a body by F t2 / 2m", 0, false, force_position);
  add("central_force", "a force at the centre of mass does not turn a body", 0, false, central_force);
  add("torque_impulse",
      "the angular momentum that a spinning body gets is the impulse of the torque, in world axes", 0, false,
      torque_impulse);
  add("rotation", "orientations follow from the angular velocity", 0, false, rotation);
  add("acceleration", "accelerations at both ends of a window fit loads and gravity", 0, false, acceleration);
  add("window_lengths", "windows of unequal lengths take their own time", 0, false, window_lengths);
  add("applied_impulse", "the recorded impulse is the load times the length of the window", 0, true,
      applied_impulse);
  add("applied_work", "the recorded work of the load is the energy that the body gets", 0, false,
      applied_work);
  add("motion_chain", "each window begins in the pose and with the velocity in which the last one ended", 0,
      true, motion_chain);
  add("window_halves", "two windows of half the length give the same motion as one", 0, true, window_halves);
  add("observe_bodies", "the frame for the results has all bodies and joints, as the last motion has them", 0,
      true, observe_bodies);
  add("energy", "the energy of a frame is kinetic and potential energy of all bodies", 0, false, energy);
}

}  // namespace tandem::conform
