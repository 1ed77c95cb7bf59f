// Each broken particle participant fails the checks that name its fault, and no others.
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "common/error.hpp"
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

// The solver gets another scene.
template <class Change>
auto scene(Change change) {
  return [change](std::string& text) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
    change(json.at("dem"));
    text = json.dump();
  };
}
template <class Change>
auto each_inlet(Change change) {
  return scene([change](nlohmann::ordered_json& dem) {
    for (auto& group : dem["particles"])
      if (group["fill"]["type"] == "inlet") change(group);
  });
}
// Spheres act on walls only. Knows the simplest contact, whose stiffness is that of a pair of materials.
void leave_out_pairs(nlohmann::ordered_json& dem) {
  if (dem.value("contact", "") != "hooke")
    throw Error(ErrorCode::scene, "is not hooke", "dem.contact", "use another solver");
  nlohmann::ordered_json glass = dem["materials"][0];
  glass["name"] = "wall";
  dem["materials"].push_back(glass);
  for (auto& wall : dem["walls"]) wall["material"] = "wall";
  dem["pairs"] = {
      {{"a", "glass"}, {"b", "glass"}, {"restitution", 1}, {"friction", 0}, {"spring_stiffness", 1e-9}}};
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
      {"torque_on_body", "linearise", "turning_wall", "loads_of_bodies"});
  add({.name = "torque_sign", .load = each_load([](BodyLoad& l) { l.mean.torque = -l.mean.torque; })},
      {"torque_on_body", "load_on_ground", "linearise", "turning_wall"});
  add({.name = "load_on_particles",
       .load = each_load([](BodyLoad& l) { l.mean.force = -l.mean.force, l.mean.torque = -l.mean.torque; })},
      {"weight_on_body", "torque_on_body", "load_on_ground", "momentum_balance", "linearise", "same_window",
       "moving_wall", "turning_wall", "load_work", "end_load", "load_moment", "sphere_stack",
       "loads_of_bodies"});
  add({.name = "scaled_load", .load = each_load([](BodyLoad& l) { l.mean.force = 0.99 * l.mean.force; })},
      {"weight_on_body", "load_on_ground", "momentum_balance", "load_work", "sphere_stack",
       "loads_of_bodies"});
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
      {"lost_particle", "inlets", "outlet"});
  add({.name = "renumbers",
       .frame =
           [](ParticlesFrame& f) {
             for (std::size_t i = 0; i < f.id.size(); ++i) f.id[i] = static_cast<std::uint32_t>(i);
           }},
      {"lost_particle", "inlets", "outlet"});
  add({.name = "late_snapshot",
       .snapshot =
           [](ParticlesFrame& f) {
             for (double& x : f.position) x += 1e-6;
           }},
      {"snapshot"});
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
      {"free_flight", "kinetic_energy", "observe_particles", "sphere_impact", "inlets"});
  add({.name = "micro_steps_too_few", .load = account([](ParticleAccount& a) {
                                        a.micro_step *= static_cast<double>(a.micro_steps);
                                        a.micro_steps = 1;
                                      })},
      {"linearise", "micro_steps"});
  add({.name = "no_contact_of_spheres", .scene = scene(leave_out_pairs)}, {"sphere_impact", "sphere_stack"});
  add({.name = "impact_without_loss", .scene = scene([](nlohmann::ordered_json& dem) {
                                        if (dem["particles"].size() == 2 &&
                                            dem["particles"][0]["name"] == "light")
                                          dem["materials"][0]["restitution"] = 1;
                                      })},
      {"sphere_impact"});
  add({.name = "swaps_bodies",
       .load =
           [](LoadSet& loads, const MotionSet& motion) {
             if (motion.bodies.size() < 2) return;
             for (BodyLoad& load : loads.bodies)
               if (load.body != ground.value) load.body = 1 - load.body;
           }},
      {"loads_of_bodies"});
  add({.name = "idle_inlets", .scene = scene([](nlohmann::ordered_json& dem) {
                                auto& groups = dem["particles"];
                                for (std::size_t i = groups.size(); i-- > 0;)
                                  if (groups[i]["fill"]["type"] == "inlet") groups.erase(i);
                              })},
      {"inlets"});
  add({.name = "inlets_at_once", .scene = each_inlet([](auto& group) {
                                   group["fill"].erase("mass_rate");
                                   group["fill"]["rate"] = 1e4;
                                 })},
      {"inlets"});
  add({.name = "inlets_elsewhere", .scene = each_inlet([](auto& group) {
                                     for (const char* corner : {"min", "max"})
                                       group["fill"][corner][1] =
                                           group["fill"][corner][1].template get<double>() - 0.25;
                                   })},
      {"inlets"});
  add({.name = "inlets_at_rest", .scene = each_inlet([](auto& group) { group.erase("velocity"); })},
      {"inlets"});
  add({.name = "idle_outlets", .scene = scene([](nlohmann::ordered_json& dem) { dem.erase("outlets"); })},
      {"outlet"});
  const auto has_outlets = std::make_shared<bool>(false);
  add({.name = "outlets_lose_spheres",
       .scene =
           [has_outlets](std::string& text) { *has_outlets = text.find("outlets") != std::string::npos; },
       .load =
           [has_outlets](LoadSet& loads, const MotionSet&) {
             if (*has_outlets && loads.window.index >= 10) loads.account.lost_particles = 1;
           }},
      {"outlet"});
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
