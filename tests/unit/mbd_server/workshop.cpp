#include "tests/unit/mbd_server/workshop.hpp"

#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {

using scene::JointType;

scene::Scene workshop() {
  scene::Scene scene = machines::empty({0, -9.81, 0});
  const Vec3d round{.01, .01, .01};
  const BodyId crank = machines::add_body(scene, "crank", 1, round, {0, .15, 0});
  const BodyId bar = machines::add_body(scene, "bar", 2, {.02, .2, .2}, {.5, .55, 0});
  const BodyId rocker = machines::add_body(scene, "rocker", 1.5, {.08, .02, .08}, {1, .4, 0});
  const BodyId wheel = machines::add_body(scene, "wheel", .8, {.004, .004, .008}, {-.5, 0, 0});
  const BodyId rack = machines::add_body(scene, "rack", .5, round, {-.5, -.1, 0});
  const BodyId spindle = machines::add_body(scene, "spindle", .3, {.002, .001, .002}, {0, 0, 1});
  const BodyId pod = machines::add_body(scene, "pod", .4, {.004, .005, .006}, {.5, .45, 0});
  const BodyId nut = machines::add_body(scene, "nut", .6, round, {0, .2, 1});

  machines::add_joint(scene, "A", JointType::revolute, ground, crank, {0, 0, 0}).rate = 2;
  scene.mbd->joints.back().friction = scene::Friction{.05, .1};
  machines::add_joint(scene, "B", JointType::revolute, crank, bar, {0, .3, 0});
  machines::add_joint(scene, "C", JointType::revolute, bar, rocker, {1, .8, 0});
  machines::add_joint(scene, "D", JointType::revolute, ground, rocker, {1, 0, 0}).damping = .02;
  machines::add_joint(scene, "E", JointType::revolute, ground, wheel, {-.5, 0, 0});
  scene::Joint& slide =
      machines::add_joint(scene, "slide", JointType::prismatic, ground, rack, {-.5, -.1, 0}, {1, 0, 0});
  slide.limits = scene::Limits{-.03, .01, 2e4, .3};
  slide.friction = scene::Friction{1, .01};
  machines::add_joint(scene, "turn", JointType::revolute, ground, spindle, {0, 0, 1}, {0, 1, 0});
  machines::add_joint(scene, "guide", JointType::prismatic, ground, nut, {0, .2, 1}, {0, 1, 0}).damping = .1;
  scene::Joint& thread =
      machines::add_joint(scene, "thread", JointType::screw, spindle, nut, {0, .2, 1}, {0, 1, 0});
  thread.pitch = .02;
  thread.cut = true;
  scene.mbd->couplers.push_back({"gear", scene::CouplerType::gear, JointId{0}, JointId{4}, -2});
  scene.mbd->couplers.push_back({"pinion", scene::CouplerType::rack_and_pinion, JointId{4}, JointId{5}, .02});

  scene::Bushing bushing{"mount", bar, pod, {.5, .5, 0}, {}, {}};
  for (int i = 0; i < 6; ++i) {
    bushing.stiffness[static_cast<std::size_t>(7 * i)] = i < 3 ? 4e3 : 20;
    bushing.damping[static_cast<std::size_t>(7 * i)] = i < 3 ? 5 : .05;
  }
  auto& forces = scene.mbd->forces;
  forces.push_back(bushing);
  scene::SpringDamper spring{"return", ground, rocker, {2, .5, 0}, {1, .6, 0}, 0, 1, 1};
  spring.table = scene::ForceTable{{-1, 0, .5, 1}, {-30, 0, 20, 60}};
  forces.push_back(spring);
  forces.push_back(scene::Actuator{"motor", JointId{6}, scene::HarmonicMotion{.05, .02, 3, 0}});
  forces.push_back(scene::BodyLoad{
      "fan", scene::BodyLoad::Kind::force, pod, {.5, .45, 0}, {1, 0, 0}, true, scene::ConstantMotion{.5, 0}});
  machines::add_wall(scene, bar);
  machines::add_wall(scene, pod);
  return scene;
}

}  // namespace tandem::mbd
