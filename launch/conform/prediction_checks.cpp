// Checks of a multibody participant: predictions, loads that are linear in time, and states to go back to.
#include "launch/conform/motion_run.hpp"
#include "launch/conform/state_folder.hpp"

namespace tandem::conform {
namespace {

using protocol::BodyLoad;
using protocol::BodyMotion;
using protocol::MotionSet;

void predict_velocity(Examination& e) {
  const MotionRun run = run_under(e, 1, 5);
  const MotionSet path = run.session->predict(H);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion &now = run.last(index), &m = motion_of(path, index);
    const Pose end = moved(now.end_pose, now.end_twist, H);
    e.compare("begin of the path of " + body.name, m.begin_pose.p_WB, now.end_pose.p_WB, rounding, "m");
    e.compare("begin of the rotation of " + body.name,
              rotation_vector(m.begin_pose.q_WB * now.end_pose.q_WB.conjugate()), {}, rounding, "rad");
    e.compare("end of the path of " + body.name, m.end_pose.p_WB, end.p_WB,
              1e-4 * H * norm(now.end_twist.v_WB) + rounding, "m");
    e.compare("end of the rotation of " + body.name, rotation_vector(m.end_pose.q_WB * end.q_WB.conjugate()),
              {}, 1e-4 * H * norm(now.end_twist.w_WB) + rounding, "rad");
    e.compare("velocity of " + body.name + " at the end", m.end_twist.v_WB, now.end_twist.v_WB,
              1e-6 * norm(now.end_twist.v_WB), "m/s");
    e.compare("impulse in a prediction for " + body.name, m.applied_impulse.force, {}, 0, "N s");
  });
}

void state_stays(Examination& e, bool extrapolate) {
  const auto with = e.open(), without = e.open();
  const auto loads = sample_loads(e.scene(), with->configured().boundary);
  bool same = true;
  for (int i = 0; i < 5; ++i) {
    if (extrapolate)
      with->extrapolate(H);
    else
      with->predict(2 * H);
    same = same && same_bits(with->advance(loads, H), without->advance(loads, H));
  }
  e.expect(same, std::string("the motion has other bits after ") + (extrapolate ? "extrapolate" : "predict") +
                     " than without: the state was changed");
}

void predict_state(Examination& e) {
  state_stays(e, false);
}
void extrapolate_state(Examination& e) {
  state_stays(e, true);
}

void extrapolate_acceleration(Examination& e) {
  const MotionRun run = run_under(e, 1, 5);
  const MotionSet path = run.session->extrapolate(H);
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion &now = run.last(index), &m = motion_of(path, index);
    const Vec3d a = e.scene().gravity + (1 / body.mass) * load_on(run.loads, index)->mean.force;
    e.compare("velocity of " + body.name + " at the end", m.end_twist.v_WB, now.end_twist.v_WB + H * a,
              position_share * H * norm(a), "m/s");
    e.compare("position of " + body.name + " at the end", m.end_pose.p_WB,
              now.end_pose.p_WB + H * now.end_twist.v_WB + (0.5 * H * H) * a,
              position_share * 0.5 * H * H * norm(a), "m");
  });
}

// A load that is linear in time without a mean moves a body by minus its moment, and leaves it its velocity.
void first_moment(Examination& e) {
  const auto session = e.open();
  const Vec3d g = e.scene().gravity;
  auto loads = sample_loads(e.scene(), session->configured().boundary);
  for (BodyLoad& load : loads) {
    load.first_moment.force = H * load.mean.force;
    load.mean = load.end = {};
  }
  MotionSet motion;
  for (int i = 0; i < run_windows; ++i) motion = session->advance(loads, H);
  const double t = session->time();
  for_each_body(e, [&](std::uint32_t index, const scene::Body& body) {
    const BodyMotion& end = motion_of(motion, index);
    const Vec3d moment = load_on(loads, index)->first_moment.force, moved_by = (-t / body.mass) * moment;
    e.compare("velocity of " + body.name, end.end_twist.v_WB, body.twist.v_WB + t * g,
              velocity_share * t * norm(g), "m/s");
    // Against the fall, which a participant of first order has by half a step only.
    e.compare("displacement of " + body.name,
              end.end_pose.p_WB - (body.pose.p_WB + t * body.twist.v_WB + (0.5 * t * t) * g), moved_by,
              0.1 * norm(moved_by), "m");
  });
}

void motion_rollback(Examination& e) {
  const auto session = e.open();
  const auto loads = sample_loads(e.scene(), session->configured().boundary);
  const auto other = sample_loads(e.scene(), session->configured().boundary, -3);
  for (int i = 0; i < 5; ++i) session->advance(loads, H);
  session->save();
  std::vector<MotionSet> first;
  for (int i = 0; i < 3; ++i) first.push_back(session->advance(loads, H));
  const protocol::BodiesFrame seen = session->bodies();
  const auto again = [&](const char* when) {
    session->restore();
    bool same = true;
    for (const MotionSet& motion : first) same = same && same_bits(session->advance(loads, H), motion);
    e.expect(same && same_bits(session->bodies(), seen),
             std::string("the same windows have other bits after ") + when);
  };
  again("restore");
  session->restore();
  for (int i = 0; i < 2; ++i) session->advance(other, 2 * H);
  again("a second restore of one save, with other windows between");
  // A later save takes the place of the first.
  session->restore();
  session->advance(other, H);
  session->save();
  const MotionSet next = session->advance(loads, H);
  session->restore();
  e.expect(same_bits(session->advance(loads, H), next), "a second save did not take the place of the first");
}

void motion_checkpoint(Examination& e) {
  const StateFolder folder;
  const auto session = e.open(folder.path());
  const auto loads = sample_loads(e.scene(), session->configured().boundary);
  for (int i = 0; i < 5; ++i) session->advance(loads, H);
  const protocol::Checkpoint file = session->checkpoint((folder.path() / "state").string());
  std::vector<MotionSet> first;
  for (int i = 0; i < 3; ++i) first.push_back(session->advance(loads, H));
  const auto resumed = e.open(folder.path());
  resumed->resume(file);
  bool same = true;
  for (const MotionSet& motion : first) same = same && same_bits(resumed->advance(loads, H), motion);
  e.expect(same, "a run that goes on from the file has other bits");
}

}  // namespace

void add_prediction_checks(std::vector<Check>& table) {
  using namespace protocol;
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, bool any,
                       void (*run)(Examination&)) {
    table.push_back({name, meaning, needs, "free_bodies", nullptr, any, run});
  };
  add("predict_velocity", "a prediction holds the velocities from the present state on", can_predict, false,
      predict_velocity);
  add("predict_state", "a prediction leaves the state alone", can_predict, true, predict_state);
  add("extrapolate_acceleration", "an extrapolation holds the accelerations", can_extrapolate, false,
      extrapolate_acceleration);
  add("extrapolate_state", "an extrapolation leaves the state alone", can_extrapolate, true,
      extrapolate_state);
  add("first_moment", "a load that is linear in time, without a mean, displaces a body by its first moment",
      can_extrapolate, false, first_moment);
  add("motion_rollback",
      "the same windows after restore have the same bits, also after a second restore of one save",
      can_rollback, true, motion_rollback);
  add("motion_checkpoint", "a run that goes on from a file has the same bits", can_checkpoint, true,
      motion_checkpoint);
}

}  // namespace tandem::conform
