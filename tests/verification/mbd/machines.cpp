#include "tests/verification/mbd/machines.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "common/cpu_time.hpp"
#include "common/scene/parse.hpp"

namespace tandem::mbd::machines {

using scene::JointType;
using scene::Scene;

Scene empty(Vec3d gravity) {
  Scene scene;
  scene.gravity = gravity;
  scene.mbd.emplace();
  return scene;
}

BodyId add_body(Scene& scene, const std::string& name, double mass, Vec3d inertia, Vec3d position) {
  scene::Body body;
  body.name = name;
  body.mass = mass;
  body.inertia = {inertia.x, inertia.y, inertia.z, 0, 0, 0};
  body.pose.p_WB = position;
  scene.mbd->bodies.push_back(body);
  return {static_cast<std::uint32_t>(scene.mbd->bodies.size() - 1)};
}

scene::Joint& add_joint(Scene& scene, const std::string& name, JointType type, BodyId parent, BodyId child,
                        Vec3d position, Vec3d axis) {
  scene::Joint joint;
  joint.name = name;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.position = position;
  joint.axis = axis;
  scene.mbd->joints.push_back(joint);
  return scene.mbd->joints.back();
}

void add_wall(Scene& scene, BodyId body) {
  if (!scene.dem) scene.dem.emplace();
  scene::Wall wall;
  wall.body = body;
  scene.dem->walls.push_back(wall);
}

Scene pendulum() {
  Scene scene = empty({0, -9.81, 0});
  const BodyId mass = add_body(scene, "mass", 1, {0, 0, 0}, {-1, 0, 0});
  add_joint(scene, "pin", JointType::revolute, ground, mass, {0, 0, 0}, {0, 0, 1});
  return scene;
}

Scene heavy_top() {
  Scene scene = empty();
  const BodyId top = add_body(scene, "top", 15, {.234375, .46875, .234375}, {0, 1, 0});
  add_joint(scene, "tip", JointType::spherical, ground, top, {0, 0, 0});
  return scene;
}

Scene free_body(double mass, Vec3d inertia, Vec3d gravity) {
  Scene scene = empty(gravity);
  add_body(scene, "body", mass, inertia, {0, 0, 0});
  return scene;
}

Scene bead(double mass, double speed) {
  Scene scene = empty({0, 0, 0});
  const BodyId body = add_body(scene, "bead", mass, {1, 1, 1}, {0, 0, 0});
  add_joint(scene, "rail", JointType::prismatic, ground, body, {0, 0, 0}, {1, 0, 0}).rate = speed;
  return scene;
}

Scene ladder(int windows) {
  Scene scene = empty({0, -9.81, 0});
  const double I = 1.0 / 12;
  std::vector<BodyId> vertical;
  for (int i = 0; i <= windows; ++i) {
    const double x = i;
    vertical.push_back(add_body(scene, "v" + std::to_string(i), 1, {I, 1e-3, I}, {x, .5, 0}));
    add_joint(scene, "a" + std::to_string(i), JointType::revolute, ground, vertical.back(), {x, 0, 0}).rate =
        -1;
  }
  for (int i = 0; i < windows; ++i) {
    const double x = i;
    const BodyId bar = add_body(scene, "h" + std::to_string(i), 1, {1e-3, I, I}, {x + .5, 1, 0});
    add_joint(scene, "b" + std::to_string(i), JointType::revolute, vertical[i], bar, {x, 1, 0});
    add_joint(scene, "c" + std::to_string(i), JointType::revolute, bar, vertical[i + 1], {x + 1, 1, 0});
  }
  return scene;
}

Scene chain(int links) {
  Scene scene = empty({0, -9.81, 0});
  const double L = .1, m = .1, I = m * L * L / 12;
  for (int i = 0; i < links; ++i) {
    const BodyId rod = add_body(scene, "r" + std::to_string(i), m, {I, I, I}, {(i + .5) * L, 0, 0});
    add_joint(scene, "j" + std::to_string(i), JointType::revolute, i == 0 ? ground : BodyId{rod.value - 1},
              rod, {i * L, 0, 0});
  }
  return scene;
}

std::string shipped_folder() {
  return TANDEM_MBD_SCENES;
}

Scene shipped(const std::string& name) {
  const std::string file = shipped_folder() + "/" + name + ".json";
  std::ifstream in(file);
  if (!in) throw std::runtime_error("there is no " + file);
  std::ostringstream text;
  text << in.rdbuf();
  return scene::parse(text.str(), file);
}

Scene menagerie() {
  Scene scene = empty({0.3, -0.2, -9.81});
  const BodyId slider = add_body(scene, "slider", 2, {.1, .2, .15}, {.1, 0, 0});
  const BodyId arm = add_body(scene, "arm", 1.5, {.05, .03, .04}, {.6, .1, .2});
  const BodyId ball = add_body(scene, "ball", .8, {.01, .02, .025}, {1.1, .2, .5});
  const BodyId tip = add_body(scene, "tip", .3, {.002, .003, .004}, {1.3, .3, .6});
  const BodyId crank = add_body(scene, "crank", .7, {.01, .01, .02}, {.2, .7, .1});
  const BodyId loose = add_body(scene, "loose", 1.1, {.03, .05, .06}, {-.5, .2, .9});
  const BodyId cap = add_body(scene, "cap", .4, {.004, .005, .006}, {-.7, .3, 1.0});
  const BodyId drum = add_body(scene, "drum", .9, {.01, .02, .01}, {-.2, -.6, .4});
  scene.mbd->bodies[ball.value].inertia = {.011, .021, .024, .002, -.001, .003};
  scene.mbd->bodies[ball.value].pose.q_WB = exp(Vec3d{.3, -.2, .5});
  scene.mbd->bodies[loose.value].twist = {{.3, -.4, .2}, {1, -2, .5}};

  add_joint(scene, "rail", JointType::prismatic, ground, slider, {0, 0, 0}, normalized(Vec3d{1, .2, 0}))
      .rate = .4;
  add_joint(scene, "elbow", JointType::revolute, slider, arm, {.3, .05, .1}, normalized(Vec3d{.2, 1, .3}))
      .rate = -1.2;
  scene.mbd->joints.back().damping = .15;
  add_joint(scene, "socket", JointType::spherical, arm, ball, {.9, .15, .3}).damping = .05;
  add_joint(scene, "twist", JointType::revolute, ball, tip, {1.2, .25, .55}, normalized(Vec3d{1, -1, .5}))
      .rate = 2.1;
  scene::Joint& drive = add_joint(scene, "drive", JointType::revolute, slider, crank, {.2, .4, 0}, {0, 0, 1});
  drive.motion = scene::HarmonicMotion{.1, .6, 1.5, .3};
  add_joint(scene, "spindle", JointType::revolute, crank, drum, {.1, .5, .1}, normalized(Vec3d{.1, .3, 1}))
      .rate = 3;
  add_joint(scene, "weld", JointType::fixed, loose, cap, {-.6, .25, .95});

  auto& forces = scene.mbd->forces;
  forces.push_back(scene::SpringDamper{"to_ground", ground, ball, {1, 1, 1}, {1.1, .3, .45}, 40, 2, .5});
  forces.push_back(scene::SpringDamper{"across", tip, loose, {1.3, .3, .65}, {-.4, .2, .8}, 25, 1.5, 1.2});
  forces.push_back(scene::SpringDamper{"along", arm, tip, {.5, .1, .2}, {1.35, .3, .6}, 30, 1, .7});
  forces.push_back(scene::SpringDamper{"branch", drum, arm, {-.2, -.5, .4}, {.7, .1, .2}, 15, .8, 1});
  forces.push_back(scene::RotationalSpringDamper{"torsion", JointId{1}, 3, .2, .4});
  add_wall(scene, tip);
  add_wall(scene, loose);
  add_wall(scene, loose);
  return scene;
}

Run::Run(const Scene& s, double h, double rho_inf, NewtonSettings newton, Constraints constraints)
    : scene(s),
      model(build_model(scene)),
      system(model),
      state(initial_state(model, scene)),
      assembly(assemble(scene, model, system, state)),
      integrator(rho_inf, newton, system, state, constraints),
      step(h) {
  integrator.start(system, state, step);
}

void Run::restart(const std::function<void(State&)>& change) {
  change(state);
  integrator.start(system, state, step);
}

void Run::advance(int steps) {
  for (int i = 0; i < steps; ++i) integrator.step(system, state, step);
}

double Run::advance_timed(int steps) {
  const double begin = cpu_seconds(CpuClock::thread);
  advance(steps);
  return cpu_seconds(CpuClock::thread) - begin;
}

Vector3d Run::position(int body) {
  system.residual(state);
  const BodyOnLink& b = model.bodies[body];
  return model.origin + system.links()[b.link].point(b.p_LB);
}

Vector3d Run::velocity(int body) {
  const Vector3d p = position(body) - model.origin;
  return system.links()[model.bodies[body].link].velocity(p);
}

JointObservation Run::joint(const std::string& name) {
  system.residual(state);
  const auto& joints = scene.mbd->joints;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].name == name) return JointObserver(model).observe(state, system.links())[j];
  throw std::runtime_error("there is no joint " + name);
}

double Run::energy() {
  system.residual(state);
  return mbd::energy(model, state, system.links());
}

}  // namespace tandem::mbd::machines
