// Each broken particle participant fails the checks that name its fault, and no others.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "launch/conform/judge.hpp"
#include "launch/conform/report.hpp"
#include "tests/doubles/broken_load.hpp"
#include "tests/doubles/thread_subject.hpp"

namespace tandem::test {
namespace {

using namespace protocol;

struct LoadCase {
  LoadFault fault;
  std::vector<std::string> failed;  // names of the checks that must fail, in the order of the table
};

template <class Change>
auto each_load(Change change) {
  return [change](LoadSet& loads, const MotionSet&) {
    for (BodyLoad& load : loads.bodies) change(load);
  };
}
template <class Change>
auto account(Change change) {
  return [change](LoadSet& loads, const MotionSet&) { change(loads.account); };
}

void PrintTo(const LoadCase& one, std::ostream* out) {
  *out << one.fault.name;
}

std::vector<LoadCase> broken_loads() {
  std::vector<LoadCase> list;
  const auto add = [&](LoadFault fault, std::vector<std::string> failed) {
    list.push_back({std::move(fault), std::move(failed)});
  };

  add({.name = "drops_torques", .load = each_load([](BodyLoad& l) { l.mean.torque = {}; })},
      {"torque_on_body", "load_on_ground", "linearise", "turning_wall"});
  add({.name = "torque_about_world_origin",
       .load =
           [](LoadSet& loads, const MotionSet& motion) {
             for (BodyLoad& load : loads.bodies)
               for (const BodyMotion& body : motion.bodies)
                 if (body.body == load.body) load.mean.torque += cross(body.begin_pose.p_WB, load.mean.force);
           }},
      {"torque_on_body", "linearise", "turning_wall"});
  add({.name = "torque_sign", .load = each_load([](BodyLoad& l) { l.mean.torque = -l.mean.torque; })},
      {"torque_on_body", "load_on_ground", "linearise", "turning_wall"});
  add({.name = "load_on_particles",
       .load = each_load([](BodyLoad& l) { l.mean.force = -l.mean.force, l.mean.torque = -l.mean.torque; })},
      {"weight_on_body", "torque_on_body", "load_on_ground", "momentum_balance", "linearise", "same_window",
       "moving_wall", "turning_wall", "load_work", "end_load", "load_moment"});
  add({.name = "scaled_load", .load = each_load([](BodyLoad& l) { l.mean.force = 0.99 * l.mean.force; })},
      {"weight_on_body", "load_on_ground", "momentum_balance", "load_work"});
  add({.name = "drops_ground",
       .load =
           [](LoadSet& loads, const MotionSet&) {
             std::erase_if(loads.bodies, [](const BodyLoad& l) { return l.body == ground.value; });
           }},
      {"load_on_ground", "momentum_balance"});
  add({.name = "load_of_last_window", .delays_load = true},
      {"momentum_balance", "linearise", "load_rollback", "same_window", "window_mean", "end_load",
       "load_moment", "particle_checkpoint"});
  add({.name = "stale_pose",
       .path =
           [](MotionSet& m) {
             for (BodyMotion& b : m.bodies) b.end_pose = b.begin_pose, b.begin_twist = b.end_twist = {};
           }},
      {"linearise", "same_window", "turning_wall", "load_work", "window_mean", "end_load", "load_moment"});
  add({.name = "walls_without_velocity",
       .path =
           [](MotionSet& m) {
             for (BodyMotion& b : m.bodies) b.begin_twist = b.end_twist = {};
           }},
      {"linearise", "same_window", "turning_wall", "load_work", "window_mean", "load_moment"});
  add({.name = "ignores_rotation",
       .path =
           [](MotionSet& m) {
             for (BodyMotion& b : m.bodies) {
               b.end_pose.q_WB = b.begin_pose.q_WB;
               b.begin_twist.w_WB = b.end_twist.w_WB = {};
             }
           }},
      {"turning_wall"});
  add({.name = "end_for_mean", .load = each_load([](BodyLoad& l) { l.mean = l.end; })},
      {"momentum_balance", "same_window", "turning_wall", "load_work", "window_mean"});
  add({.name = "mean_for_end", .load = each_load([](BodyLoad& l) { l.end = l.mean; })}, {"end_load"});
  add({.name = "drops_first_moment", .load = each_load([](BodyLoad& l) { l.first_moment = {}; })},
      {"load_moment"});
  add({.name = "moment_from_begin",
       .load =
           [](LoadSet& loads, const MotionSet&) {
             for (BodyLoad& l : loads.bodies)
               l.first_moment.force += (0.5 * loads.window.length()) * l.mean.force;
           }},
      {"load_moment"});
  add({.name = "drops_work", .load = each_load([](BodyLoad& l) { l.work = 0; })},
      {"turning_wall", "load_work"});
  add({.name = "work_sign", .load = each_load([](BodyLoad& l) { l.work = -l.work; })},
      {"turning_wall", "load_work"});
  add({.name = "lost_rollback", .restores_roughly = true}, {"load_rollback"});
  add({.name = "lost_checkpoint", .resumes_roughly = true}, {"particle_checkpoint"});
  add({.name = "tangent_sign",
       .tangents =
           [](TangentSet& t) {
             for (BodyTangent& b : t.bodies)
               for (double& k : b.stiffness) k = -k;
           }},
      {"linearise"});
  add({.name = "no_damping",
       .tangents =
           [](TangentSet& t) {
             for (BodyTangent& b : t.bodies) b.damping = {};
           }},
      {"linearise"});
  add({.name = "counts_no_losses", .load = account([](ParticleAccount& a) { a.lost_particles = 0; })},
      {"lost_particle"});
  add({.name = "forgets_lost_momentum", .load = account([](ParticleAccount& a) { a.lost_momentum = {}; })},
      {"lost_particle"});
  add({.name = "renumbers",
       .frame =
           [](ParticlesFrame& f) {
             for (std::size_t i = 0; i < f.id.size(); ++i) f.id[i] = static_cast<std::uint32_t>(i);
           }},
      {"lost_particle"});
  add({.name = "unwrapped",
       .frame =
           [](ParticlesFrame& f) {
             if (f.id.size() == 1 && f.position[0] < 0.5 && f.velocity[0] > 1) f.position[0] += 1;
           }},
      {"periodic"});
  add({.name = "spinless_energy", .load = account([](ParticleAccount& a) { a.kinetic_energy *= 0.99; })},
      {"kinetic_energy"});
  add({.name = "no_gravity_in_account", .load = account([](ParticleAccount& a) { a.gravity_impulse = {}; })},
      {"momentum_balance", "free_flight"});
  add({.name = "momentum_of_middle", .load = account([](ParticleAccount& a) {
                                       a.momentum_begin = 0.5 * (a.momentum_begin + a.momentum_end);
                                     })},
      {"momentum_balance", "free_flight", "account_chain"});
  add({.name = "frame_without_velocity",
       .frame =
           [](ParticlesFrame& f) {
             for (float& v : f.velocity) v = 0;
           }},
      {"free_flight", "kinetic_energy", "observe_particles"});
  add({.name = "micro_steps_too_few", .load = account([](ParticleAccount& a) {
                                        a.micro_step *= static_cast<double>(a.micro_steps);
                                        a.micro_steps = 1;
                                      })},
      {"linearise", "micro_steps"});
  return list;
}

class BrokenLoadTest : public testing::TestWithParam<LoadCase> {};

TEST_P(BrokenLoadTest, FailsTheChecksThatNameItsFaultAndNoOthers) {
  const LoadCase& broken_one = GetParam();
  ThreadSubject subject(Role::dem, std::function([&] { return broken(broken_one.fault); }));
  const conform::Judgement judgement = conform::judge(subject, {});
  for (const conform::Result& result : judgement.results)
    if (result.outcome == conform::Outcome::failed) std::printf("%s", conform::row(result).c_str());
  EXPECT_EQ(judgement.failed(), broken_one.failed);
  EXPECT_FALSE(judgement.passed());
}

INSTANTIATE_TEST_SUITE_P(Faults, BrokenLoadTest, testing::ValuesIn(broken_loads()),
                         [](const auto& one) { return one.param.fault.name; });

}  // namespace
}  // namespace tandem::test
