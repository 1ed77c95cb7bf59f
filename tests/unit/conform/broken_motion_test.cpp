// Each broken multibody participant fails the checks that name its fault, and no others.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "launch/conform/judge.hpp"
#include "launch/conform/report.hpp"
#include "tests/doubles/broken_motion.hpp"
#include "tests/doubles/thread_subject.hpp"

namespace tandem::test {
namespace {

using namespace protocol;

struct MotionCase {
  MotionFault fault;
  std::vector<std::string> failed;  // names of the checks that must fail, in the order of the table
};

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

Quat turned_back(const BodyMotion& motion) {
  return motion.begin_pose.q_WB.conjugate();
}

void PrintTo(const MotionCase& one, std::ostream* out) {
  *out << one.fault.name;
}

std::vector<MotionCase> broken_motions() {
  std::vector<MotionCase> list;
  const auto add = [&](MotionFault fault, std::vector<std::string> failed) {
    list.push_back({std::move(fault), std::move(failed)});
  };
  const auto echoes = [](MotionSet& motion, const LoadSet& given) {
    // It reports the load that it was given, whatever it has done with it.
    for (BodyMotion& body : motion.bodies)
      for (const BodyLoad& load : given.bodies)
        if (load.body == body.body)
          body.applied_impulse = {given.window.length() * load.mean.force,
                                  given.window.length() * load.mean.torque};
  };

  add({.name = "drops_torques",
       .load =
           [](LoadSet& loads) {
             for (BodyLoad& load : loads.bodies) load.mean.torque = {};
           },
       .motion = echoes},
      {"torque_impulse", "acceleration", "joint_reaction", "joint_motion"});
  add({.name = "torque_sign",
       .load =
           [](LoadSet& loads) {
             for (BodyLoad& load : loads.bodies) load.mean.torque = -load.mean.torque;
           },
       .motion = echoes},
      {"torque_impulse", "acceleration", "joint_reaction", "joint_motion"});
  add({.name = "force_sign",
       .load =
           [](LoadSet& loads) {
             for (BodyLoad& load : loads.bodies) load.mean.force = -load.mean.force;
           },
       .motion = echoes},
      {"force_impulse", "force_position", "acceleration", "extrapolate_acceleration", "joint_reaction",
       "joint_motion"});
  add({.name = "swaps_bodies",
       .load =
           [](LoadSet& loads) {
             if (loads.bodies.size() == 2) std::swap(loads.bodies[0].mean, loads.bodies[1].mean);
           },
       .motion = echoes},
      {"force_impulse", "force_position", "torque_impulse", "acceleration", "extrapolate_acceleration",
       "joint_reaction", "joint_motion"});
  add({.name = "load_of_last_window", .motion = echoes, .delays_load = true},
      {"force_impulse", "force_position", "torque_impulse", "window_halves", "motion_rollback",
       "motion_checkpoint", "joint_motion"});
  add({.name = "gravity_in_other_units",
       .scene =
           [](Configuration& c) {
             replace(c.scene_text, "[0.4, -0.7, -9.7]", "[0.0004, -0.0007, -0.0097]");
             replace(c.scene_text, "[0, 0, -9.81]", "[0, 0, -0.00981]");
           }},
      {"free_fall", "force_impulse", "force_position", "acceleration", "window_lengths", "applied_work",
       "energy", "extrapolate_acceleration", "first_moment", "joint_reaction"});
  add({.name = "drops_impulse_record",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) b.applied_impulse.torque = {};
           }},
      {"applied_impulse"});
  add({.name = "work_sign",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) b.applied_work = -b.applied_work;
           }},
      {"applied_work"});
  add({.name = "stale_pose",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) b.end_pose = b.begin_pose;
           }},
      {"free_fall", "force_position", "torque_impulse", "rotation", "applied_work", "motion_chain",
       "window_halves", "observe_bodies", "predict_velocity", "extrapolate_acceleration", "first_moment"});
  add({.name = "stale_rotation",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) b.end_pose.q_WB = b.begin_pose.q_WB;
           }},
      {"torque_impulse", "rotation", "motion_chain", "observe_bodies", "predict_velocity"});
  add({.name = "spin_in_body_axes",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) {
               b.end_twist.w_WB = b.end_pose.q_WB.conjugate().rotate(b.end_twist.w_WB);
               b.begin_twist.w_WB = turned_back(b).rotate(b.begin_twist.w_WB);
             }
           }},
      {"torque_impulse", "rotation", "acceleration", "observe_bodies", "predict_velocity"});
  add({.name = "no_gravity_in_accelerations",
       .motion =
           [](MotionSet& m, const LoadSet&) {
             for (BodyMotion& b : m.bodies) b.begin_a = b.end_a = b.end_a - Vec3d{0.4, -0.7, -9.7};
           }},
      {"acceleration"});
  add({.name = "drops_first_moment",
       .load =
           [](LoadSet& loads) {
             for (BodyLoad& load : loads.bodies) load.first_moment = {};
           }},
      {"first_moment"});
  add({.name = "extrapolates_in_predict", .predicts_by_advancing = true}, {"predict_velocity"});
  add({.name = "predicts_half",
       .predicted =
           [](MotionSet& m) {
             for (BodyMotion& b : m.bodies) b.end_pose.p_WB = 0.5 * (b.begin_pose.p_WB + b.end_pose.p_WB);
           }},
      {"predict_velocity"});
  add({.name = "holds_velocity_in_extrapolate",
       .extrapolated =
           [](MotionSet& m) {
             for (BodyMotion& b : m.bodies) b.end_twist = b.begin_twist;
           }},
      {"extrapolate_acceleration"});
  add({.name = "predict_moves_state", .residue = Residue::predict}, {"predict_state"});
  add({.name = "extrapolate_moves_state", .residue = Residue::extrapolate}, {"extrapolate_state"});
  add({.name = "lost_rollback", .residue = Residue::restore}, {"motion_rollback"});
  add({.name = "restores_once", .residue = Residue::second_restore}, {"motion_rollback"});
  add({.name = "lost_checkpoint", .residue = Residue::resume}, {"motion_checkpoint"});
  add({.name = "keeps_control_in_restore", .keeps_control_in_restore = true}, {"control"});
  add({.name = "reaction_at_centre_of_mass",
       .frame =
           [](BodiesFrame& f) {
             if (f.joints.size() != 2) return;
             f.joints[0].reaction.torque += cross(Vec3d{-0.5, 0, -0.2}, f.joints[0].reaction.force);
             f.joints[1].reaction.torque += cross(Vec3d{-0.2, -0.1, 0.5}, f.joints[1].reaction.force);
           }},
      {"joint_reaction"});
  add({.name = "reaction_sign",
       .frame =
           [](BodiesFrame& f) {
             for (JointState& j : f.joints) j.reaction = {-j.reaction.force, -j.reaction.torque};
           }},
      {"joint_reaction"});
  add({.name = "joint_sign",
       .frame =
           [](BodiesFrame& f) {
             for (JointState& j : f.joints) j.q = -j.q, j.rate = -j.rate;
           }},
      {"joint_motion", "control"});
  add({.name = "swaps_elements",
       .frame =
           [](BodiesFrame& f) {
             if (f.elements.size() == 4) std::swap(f.elements[0], f.elements[1]);
           }},
      {"elements"});
  add({.name = "drops_an_element",
       .frame =
           [](BodiesFrame& f) {
             if (!f.elements.empty()) f.elements.pop_back();
           }},
      {"elements"});
  add({.name = "kinetic_energy_only",
       .frame =
           [](BodiesFrame& f) {
             for (const BodyState& b : f.bodies) {
               const double masses[] = {3, 1, 0.7};
               if (f.bodies.size() == 3)
                 f.energy += masses[b.body] * dot(Vec3d{0.4, -0.7, -9.7}, b.pose.p_WB);
             }
           }},
      {"energy"});
  add({.name = "frame_of_begin",
       .frame =
           [](BodiesFrame& f) {
             for (BodyState& b : f.bodies) b.pose.p_WB -= 1e-3 * b.twist.v_WB;
           }},
      {"observe_bodies", "energy"});
  add({.name = "start_at_origin",
       .configured =
           [](Configured& c) {
             for (BodyMotion& b : c.boundary) b.begin_pose.p_WB = b.end_pose.p_WB = {};
           }},
      {"start_state"});
  return list;
}

class BrokenMotionTest : public testing::TestWithParam<MotionCase> {};

TEST_P(BrokenMotionTest, FailsTheChecksThatNameItsFaultAndNoOthers) {
  const MotionCase& broken_one = GetParam();
  ThreadSubject subject(Role::mbd, std::function([&] { return broken(broken_one.fault); }));
  const conform::Judgement judgement = conform::judge(subject, {});
  for (const conform::Result& result : judgement.results)
    if (result.outcome == conform::Outcome::failed) std::printf("%s", conform::row(result).c_str());
  EXPECT_EQ(judgement.failed(), broken_one.failed);
  EXPECT_FALSE(judgement.passed());
}

INSTANTIATE_TEST_SUITE_P(Faults, BrokenMotionTest, testing::ValuesIn(broken_motions()),
                         [](const auto& one) { return one.param.fault.name; });

}  // namespace
}  // namespace tandem::test
