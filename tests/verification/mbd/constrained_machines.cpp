#include "tests/verification/mbd/constrained_machines.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <stdexcept>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

using machines::add_body;
using machines::add_joint;
using scene::JointType;
using scene::Scene;

constexpr double pi = std::numbers::pi;

Scene empty(Vec3d gravity = {3, 1, -9}) {
  Scene scene = machines::empty(gravity);
  scene.mbd->integrator.rho_inf = 0.9;
  scene.mbd->integrator.step = 2e-3;
  return scene;
}

Quat turn(Vec3d axis, double angle) {
  return exp(angle * axis);
}

void push(Scene& scene, const std::string& name, BodyId body, Vec3d point, Vec3d direction, double size) {
  scene::BodyLoad load;
  load.name = name, load.kind = scene::BodyLoad::Kind::force, load.body = body;
  load.point = point, load.direction = normalized(direction);
  load.size = scene::ConstantMotion{size, 0};
  scene.mbd->forces.push_back(load);
}

void twist(Scene& scene, const std::string& name, BodyId body, Vec3d direction, double size) {
  scene::BodyLoad load;
  load.name = name, load.kind = scene::BodyLoad::Kind::torque, load.body = body;
  load.direction = normalized(direction);
  load.size = scene::ConstantMotion{size, 0};
  scene.mbd->forces.push_back(load);
}

void add_spring(Scene& scene, const std::string& name, BodyId a, BodyId b, Vec3d point_a, Vec3d point_b,
                double stiffness, double damping, double length) {
  scene::SpringDamper spring;
  spring.name = name, spring.body_a = a, spring.body_b = b;
  spring.point_a = point_a, spring.point_b = point_b;
  spring.stiffness = stiffness, spring.damping = damping, spring.length = length;
  scene.mbd->forces.push_back(spring);
}

// A rod of constant length from the point `from` of the parent to the point `to` of the child.
scene::Joint& add_rod(Scene& scene, const std::string& name, BodyId parent, BodyId child, Vec3d from,
                      Vec3d to) {
  scene::Joint& joint = add_joint(scene, name, JointType::distance, parent, child, from);
  joint.child_position = to;
  joint.length = norm(to - from);
  return joint;
}

// A uniform rod from a to b.
BodyId add_rod_body(Scene& scene, const std::string& name, Vec3d a, Vec3d b, double mass = 1) {
  const double J = mass * dot(b - a, b - a) / 12;
  const BodyId body = add_body(scene, name, mass, {.05 * J, J, J}, .5 * (a + b));
  const Vec3d d = normalized(b - a);
  // Turns x to d.
  const Vec3d half = normalized(d + Vec3d{1, 0, 0});
  const Vec3d v = cross({1, 0, 0}, half);
  scene.mbd->bodies.back().pose.q_WB = Quat{half.x, v.x, v.y, v.z}.normalized();
  return body;
}

// Two rods keep the point `at` of the body on a line along `axis`, to first order.
void add_steady(Scene& scene, const std::string& name, BodyId body, Vec3d at, Vec3d axis) {
  const Vec3d other = std::abs(axis.z) < .7 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
  const Vec3d u = normalized(cross(axis, other)), v = cross(axis, u);
  add_rod(scene, name + "_u", ground, body, at + u, at);
  add_rod(scene, name + "_v", ground, body, at + v, at);
}

// The scene with other types of some joints, and without those of type `free`. A universal joint keeps the
// axis as its first one; the second one is across it and `beside`.
Scene loosened(const Scene& given, const std::map<std::string, JointType>& types, Vec3d beside = {1, 0, 0}) {
  Scene scene = given;
  for (scene::Joint& joint : scene.mbd->joints) {
    const auto found = types.find(joint.name);
    if (found == types.end()) continue;
    joint.type = found->second;
    joint.axis2 = normalized(cross(joint.axis, beside));
  }
  std::erase_if(scene.mbd->joints, [](const scene::Joint& joint) { return joint.type == JointType::free; });
  return scene;
}

// Which joints of a shipped scene with redundant equations are loosened so that none is left.
const std::map<std::string, std::map<std::string, JointType>>& loose_joints() {
  using enum JointType;
  static const std::map<std::string, std::map<std::string, JointType>> list{
      {"bricard", {{"p3", universal}}},
      {"closed_chain", {{"j3", universal}, {"j6", spherical}}},
      {"dead_point", {{"big_end", spherical}, {"small_end", universal}}},
      {"engine",
       {{"main2", free},
        {"main3", free},
        {"main4", free},
        {"main5", free},
        {"big_end1", universal},
        {"big_end2", universal},
        {"big_end3", universal},
        {"big_end4", universal},
        {"small_end1", universal},
        {"small_end2", universal},
        {"small_end3", universal},
        {"small_end4", universal}}},
      {"four_bars", {{"b0", universal}, {"c0", spherical}, {"b1", universal}, {"c1", spherical}}},
      {"squeezer",
       {{"F", universal},
        {"G", universal},
        {"H", universal},
        {"E3", spherical},
        {"E4", spherical},
        {"E6", spherical}}}};
  return list;
}

// ---- one body

Scene shaft(int bearings) {
  Scene scene = empty();
  const BodyId s = add_body(scene, "s", 3, {.3, .25, .02}, {.15, .02, .45});
  for (int i = 0; i < bearings; ++i)
    add_joint(scene, "b" + std::to_string(i), JointType::revolute, ground, s, {.1, 0, .2 + .5 * i});
  twist(scene, "t", s, {0, 0, 1}, .3);
  return scene;
}

Scene door(const std::vector<JointType>& hinges) {
  Scene scene = empty({3, 1, -9.81});
  const BodyId d = add_body(scene, "door", 20, {2, 5, 3}, {.45, .03, 1});
  scene.mbd->bodies.back().pose.q_WB = turn({0, 0, 1}, .2);
  for (std::size_t i = 0; i < hinges.size(); ++i)
    add_joint(scene, "h" + std::to_string(i), hinges[i], ground, d, {0, 0, .2 + .8 * static_cast<double>(i)});
  return scene;
}

// A tall door whose hinges are near each other.
Scene door_with_close_hinges(int hinges) {
  Scene scene = empty({3, 1, -9.81});
  const BodyId d = add_body(scene, "door", 30, {9, 10, 2}, {.45, .03, 1});
  for (int i = 0; i < hinges; ++i)
    add_joint(scene, "h" + std::to_string(i), JointType::revolute, ground, d, {0, 0, 1 + .05 * i});
  return scene;
}

// Four beams welded to a ring, which hangs on a hinge.
Scene welded_frame(bool closed) {
  Scene scene = empty();
  const Vec3d corner[] = {{.1, 0, 0}, {.9, 0, .1}, {.8, .1, -.9}, {0, .05, -1}};
  BodyId beam[4];
  for (int i = 0; i < 4; ++i)
    beam[i] = add_rod_body(scene, "beam" + std::to_string(i), corner[i], corner[(i + 1) % 4], 1 + .5 * i);
  add_joint(scene, "hinge", JointType::revolute, ground, beam[0], {.5, 0, .05}, {0, 1, 0});
  for (int i = 0; i < (closed ? 4 : 3); ++i)
    add_joint(scene, "weld" + std::to_string(i), JointType::fixed, beam[i], beam[(i + 1) % 4],
              corner[(i + 1) % 4]);
  return scene;
}

// Five bodies thrown into the air, with a rod from each to each other: one rod more than makes them rigid.
Scene truss(bool redundant) {
  Scene scene = empty();
  const Vec3d at[] = {{0, 0, 0}, {1, .1, 0}, {.3, .9, .1}, {.4, .3, .8}, {.5, .4, -.7}};
  std::vector<BodyId> body;
  for (int i = 0; i < 5; ++i) {
    body.push_back(add_body(scene, "p" + std::to_string(i), 1 + .2 * i, {.01, .02, .015}, at[i]));
    scene.mbd->bodies.back().twist = {cross({1, 2, -1}, at[i]), {1, 2, -1}};
  }
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = i + 1; j < 5; ++j)
      if (redundant || i < 3 || j < 4)
        add_rod(scene, "rod" + std::to_string(i) + std::to_string(j), body[i], body[j], at[i], at[j]);
  return scene;
}

Scene guided(const std::vector<JointType>& guides) {
  Scene scene = empty();
  const BodyId body = add_body(scene, "table", 4, {.2, .1, .15}, {.3, .05, .1});
  const Vec3d at[] = {{.1, .2, .1}, {.4, -.2, .1}, {.2, 0, .3}};
  for (std::size_t i = 0; i < guides.size(); ++i)
    add_joint(scene, "g" + std::to_string(i), guides[i], ground, body, at[i], {1, 0, 0});
  add_spring(scene, "s", ground, body, {-.4, 0, .1}, {.3, 0, .1}, 300, 4, .6);
  return scene;
}

Scene bar_on_balls(bool determinate) {
  Scene scene = empty();
  const BodyId bar = add_body(scene, "bar", 2, {.01, .2, .22}, {.4, .02, .01});
  add_joint(scene, "a", JointType::spherical, ground, bar, {0, 0, 0});
  if (determinate)
    add_steady(scene, "b", bar, {.8, 0, 0}, {1, 0, 0});
  else
    add_joint(scene, "b", JointType::spherical, ground, bar, {.8, 0, 0});
  twist(scene, "t", bar, {1, .3, 0}, .2);
  return scene;
}

// On a carriage that is shaken: nothing but the carriage moves.
Scene table_on_legs(bool determinate) {
  Scene scene = empty();
  const BodyId carriage = add_body(scene, "carriage", 5, {.3, .3, .5}, {0, 0, 0});
  const BodyId table = add_body(scene, "table", 8, {.6, .5, 1}, {.05, .02, .7});
  add_joint(scene, "rail", JointType::prismatic, ground, carriage, {0, 0, -.1}, {1, 0, 0});
  if (determinate)
    add_joint(scene, "leg0", JointType::fixed, carriage, table, {.4, .3, .1});
  else
    for (int i = 0; i < 4; ++i)
      add_joint(scene, "leg" + std::to_string(i), JointType::spherical, carriage, table,
                {i % 2 ? .4 : -.4, i / 2 ? .3 : -.3, .1});
  add_spring(scene, "s", ground, carriage, {-.8, .1, 0}, {0, .1, 0}, 2000, 0, .9);
  return scene;
}

// ---- Cardan shafts

// Two shafts whose axes meet at 30 degrees.
Scene cardan(bool driven, bool determinate) {
  Scene scene = empty({0, 0, 0});
  const double c = std::cos(pi / 6), s = std::sin(pi / 6);
  const Vec3d cross_at{.4, -.3, .2}, out_axis{c, s, 0}, B = cross_at + .5 * out_axis,
                                                        A = cross_at + Vec3d{-.5, 0, 0};
  const BodyId in = add_body(scene, "in", 1, {.1, .15, .12}, A);
  const BodyId out = add_body(scene, "out", 1, {.1, .14, .13}, B);
  scene.mbd->bodies.back().pose.q_WB = turn({0, 0, 1}, pi / 6);
  scene::Joint& a = add_joint(scene, "A", JointType::revolute, ground, in, A, {1, 0, 0});
  if (driven)
    a.motion = scene::ConstantMotion{0, 10};
  else
    a.rate = 10;
  add_joint(scene, "U", JointType::universal, in, out, cross_at, {0, 0, 1}).axis2 = {-s, c, 0};
  if (determinate)
    add_steady(scene, "B", out, B, out_axis);
  else
    add_joint(scene, "B", JointType::revolute, ground, out, B, out_axis);
  return scene;
}

// Two joints with a shaft between them: input and output are parallel.
Scene double_cardan(bool determinate) {
  Scene scene = empty();
  const double c = std::cos(.5), s = std::sin(.5);
  const Vec3d axis{c, s, 0}, across{-s, c, 0}, end = .8 * axis;
  const BodyId in = add_body(scene, "in", 1, {.02, .05, .05}, {-.3, 0, 0});
  const BodyId mid = add_body(scene, "mid", 2, {.02, .12, .12}, .4 * axis);
  const BodyId out = add_body(scene, "out", 1.5, {.03, .06, .06}, end + Vec3d{.3, 0, 0});
  scene.mbd->bodies[mid.value].pose.q_WB = turn({0, 0, 1}, .5);
  add_joint(scene, "A", JointType::revolute, ground, in, {-.4, 0, 0}, {1, 0, 0}).rate = 6;
  add_joint(scene, "U", JointType::universal, in, mid, {0, 0, 0}, {0, 0, 1}).axis2 = across;
  add_joint(scene, "V", JointType::universal, mid, out, end, across).axis2 = {0, 0, 1};
  add_joint(scene, "B", determinate ? JointType::cylindrical : JointType::revolute, ground, out,
            end + Vec3d{.5, 0, 0}, {1, 0, 0});
  twist(scene, "t", out, {1, 0, 0}, -.4);
  return scene;
}

// ---- planar linkages of hinges in space

// The joints of one loop can be loosened: the third to a ball, the last to a universal joint.
Scene four_bar(bool determinate, bool controlled = false) {
  Scene scene = empty();
  const Vec3d O{0, 0, 0}, A{.12, .16, 0}, B{.62, .45, 0}, C{.7, 0, 0};
  const BodyId crank = add_rod_body(scene, "crank", O, A, .5),
               coupler = add_rod_body(scene, "coupler", A, B, 1.2),
               rocker = add_rod_body(scene, "rocker", C, B, .8);
  add_joint(scene, "O", JointType::revolute, ground, crank, O).rate = 8;
  add_joint(scene, "A", JointType::revolute, crank, coupler, A);
  if (determinate) {
    add_joint(scene, "B", JointType::spherical, coupler, rocker, B);
    scene.mbd->joints[1].type = JointType::universal;
    scene.mbd->joints[1].axis2 = normalized(cross({0, 0, 1}, B - A));
  } else {
    add_joint(scene, "B", JointType::revolute, coupler, rocker, B);
  }
  add_joint(scene, "C", JointType::revolute, ground, rocker, C);
  if (controlled) {
    scene.mbd->integrator.step.reset();
    scene.mbd->integrator.error_tolerance = 1e-7;
  }
  return scene;
}

// A door on two hinges with a hand-sized four-bar 50 m away.
Scene small_and_large(bool determinate) {
  Scene scene = door(determinate ? std::vector{JointType::revolute}
                                 : std::vector{JointType::revolute, JointType::revolute});
  const Scene other = test::moved(test::in_units(four_bar(determinate), .1, 1e-3),
                                  test::RigidMotion(turn(normalized(Vec3d{1, 1, 1}), .4), {}, {30, -40, 10}));
  for (scene::Body body : other.mbd->bodies) scene.mbd->bodies.push_back(body);
  for (scene::Joint joint : other.mbd->joints) {
    joint.child.value += 1;
    if (joint.parent != ground) joint.parent.value += 1;
    scene.mbd->joints.push_back(joint);
  }
  return scene;
}

Scene light_and_heavy(bool determinate) {
  Scene scene = four_bar(determinate);
  const double factor[] = {1e4, 1e-4, 1};
  for (std::size_t b = 0; b < 3; ++b) {
    scene.mbd->bodies[b].mass *= factor[b];
    for (double& moment : scene.mbd->bodies[b].inertia) moment *= factor[b];
  }
  return scene;
}

// Three parallel cranks of which two would do.
Scene parallelogram(bool determinate) {
  Scene scene = empty({1, -9.81, 0});
  const Vec3d arm{.3, -.4, 0};
  const Vec3d foot[] = {{0, 0, 0}, {.7, 0, 0}, {1.6, 0, 0}};
  BodyId crank[3];
  for (int i = 0; i < 3; ++i)
    crank[i] = add_rod_body(scene, "crank" + std::to_string(i), foot[i], foot[i] + arm);
  const BodyId bar = add_rod_body(scene, "bar", arm, foot[2] + arm, 2);
  for (int i = 0; i < 3; ++i)
    add_joint(scene, "foot" + std::to_string(i), JointType::revolute, ground, crank[i], foot[i]);
  scene.mbd->joints.front().rate = 1;
  add_joint(scene, "top0", JointType::revolute, crank[0], bar, foot[0] + arm);
  if (!determinate) {
    add_joint(scene, "top1", JointType::revolute, crank[1], bar, foot[1] + arm);
    add_joint(scene, "top2", JointType::revolute, crank[2], bar, foot[2] + arm);
    return scene;
  }
  // The second crank as in four_bar(); the third one turns with the first.
  scene.mbd->joints.back().type = JointType::universal;
  scene.mbd->joints.back().axis2 = {0, 1, 0};
  add_joint(scene, "top1", JointType::spherical, crank[1], bar, foot[1] + arm);
  scene::Coupler coupler;
  coupler.name = "third", coupler.type = scene::CouplerType::belt;
  coupler.joint_a = JointId{0}, coupler.joint_b = JointId{2}, coupler.ratio = 1;
  scene.mbd->couplers.push_back(coupler);
  return scene;
}

Scene slider_crank(bool determinate) {
  Scene scene = empty();
  scene.mbd->integrator.step = 5e-4;
  const Vec3d O{0, 0, 0}, A{.06, .08, 0}, B{.06 + .4 * std::cos(std::asin(.2)), 0, 0};
  const BodyId crank = add_rod_body(scene, "crank", O, A, 2), rod = add_rod_body(scene, "rod", A, B, .7),
               piston = add_body(scene, "piston", .5, {.001, .001, .001}, B + Vec3d{.02, 0, 0});
  add_joint(scene, "main", JointType::revolute, ground, crank, O).rate = 20;
  add_joint(scene, "big_end", determinate ? JointType::spherical : JointType::revolute, crank, rod, A);
  add_joint(scene, "small_end", determinate ? JointType::universal : JointType::revolute, rod, piston, B)
      .axis2 = {0, 1, 0};
  add_joint(scene, "bore", JointType::prismatic, ground, piston, B, {1, 0, 0});
  push(scene, "gas", piston, B, {-1, 0, 0}, 30);
  return scene;
}

// Two slides at right angles, joined by a bar; a second guide next to the first slide.
Scene trammel(bool determinate) {
  Scene scene = empty();
  const Vec3d A{.3, 0, 0}, B{0, .4, 0};
  const BodyId a = add_body(scene, "a", 1, {.01, .02, .02}, A),
               b = add_body(scene, "b", 1.5, {.02, .01, .02}, B), bar = add_rod_body(scene, "bar", A, B, 2);
  add_joint(scene, "guide_a", JointType::prismatic, ground, a, A, {1, 0, 0});
  if (!determinate)
    add_joint(scene, "second_a", JointType::prismatic, ground, a, A + Vec3d{0, 0, .1}, {1, 0, 0});
  add_joint(scene, "guide_b", JointType::prismatic, ground, b, B, {0, 1, 0});
  add_joint(scene, "pin_a", determinate ? JointType::spherical : JointType::revolute, a, bar, A);
  add_joint(scene, "pin_b", determinate ? JointType::universal : JointType::revolute, bar, b, B).axis2 =
      normalized(cross({0, 0, 1}, B - A));
  return scene;
}

// Two wedges: all joints slide, and all directions are in one plane.
Scene wedges() {
  Scene scene = empty({2, -9, 1});
  const Vec3d slope = normalized(Vec3d{2, 1, 0});
  const BodyId low = add_body(scene, "low", 2, {.01, .02, .02}, {.3, .1, 0}),
               high = add_body(scene, "high", 1, {.01, .01, .02}, {.35, .3, 0});
  add_joint(scene, "floor", JointType::prismatic, ground, low, {.3, 0, 0}, {1, 0, 0});
  add_joint(scene, "slope", JointType::prismatic, low, high, {.35, .2, 0}, slope);
  add_joint(scene, "wall", JointType::prismatic, ground, high, {.35, .4, 0}, {0, 1, 0});
  add_spring(scene, "s", ground, low, {-.3, .1, 0}, {.3, .1, 0}, 200, 2, .5);
  return scene;
}

// Pairs of crossing bars on top of each other; the lowest pair stands on a hinge and a slide.
Scene scissor_lift(int stages) {
  Scene scene = empty({1, -9.81, 0});
  const double w = .6, h = .4;
  std::vector<BodyId> left, right;  // bars that begin at the left, at the right
  for (int i = 0; i < stages; ++i) {
    const double y = i * h;
    left.push_back(add_rod_body(scene, "l" + std::to_string(i), {0, y, 0}, {w, y + h, 0}));
    right.push_back(add_rod_body(scene, "r" + std::to_string(i), {w, y, 0}, {0, y + h, 0}));
  }
  const BodyId shoe = add_body(scene, "shoe", .3, {.001, .001, .001}, {w, 0, 0});
  add_joint(scene, "foot", JointType::revolute, ground, left[0], {0, 0, 0}).rate = .5;
  add_joint(scene, "slide", JointType::prismatic, ground, shoe, {w, 0, 0}, {1, 0, 0});
  add_joint(scene, "heel", JointType::revolute, shoe, right[0], {w, 0, 0});
  for (int i = 0; i < stages; ++i) {
    add_joint(scene, "c" + std::to_string(i), JointType::revolute, left[i], right[i],
              {w / 2, (i + .5) * h, 0});
    if (i == 0) continue;
    add_joint(scene, "p" + std::to_string(i), JointType::revolute, right[i - 1], left[i], {0, i * h, 0});
    add_joint(scene, "q" + std::to_string(i), JointType::revolute, left[i - 1], right[i], {w, i * h, 0});
  }
  push(scene, "lift", shoe, {w, 0, 0}, {-1, 0, 0}, 60);
  return scene;
}

// ---- spatial linkages

// A hinge of a ring in space.
struct Hinge {
  Vec3d point, axis;
};

// The ring of the bodies between hinges, the last of which is the ground.
Scene ring(const std::vector<Hinge>& hinges, double rate,
           const std::map<std::size_t, JointType>& loose = {}) {
  Scene scene = empty();
  BodyId last = ground;
  for (std::size_t i = 0; i < hinges.size(); ++i) {
    BodyId next = ground;
    if (i + 1 < hinges.size())
      next = add_rod_body(scene, "r" + std::to_string(i), hinges[i].point, hinges[i + 1].point,
                          1 + .3 * static_cast<double>(i));
    const auto found = loose.find(i);
    const JointType type = found == loose.end() ? JointType::revolute : found->second;
    const bool to_ground = next == ground;
    scene::Joint& joint = add_joint(scene, "h" + std::to_string(i), type, to_ground ? ground : last,
                                    to_ground ? last : next, hinges[i].point, hinges[i].axis);
    if (type == JointType::universal)
      joint.axis2 =
          normalized(cross(joint.axis, std::abs(joint.axis.x) < .7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
    if (i == 0) joint.rate = rate;
    last = next;
  }
  return scene;
}

// Bennett (1903): opposite bars have equal lengths a, b and twists, sin(alpha) / a = sin(beta) / b; the hinge
// angles are tied by tan(t1/2) tan(t2/2) = sin((alpha + beta)/2) / sin((beta - alpha)/2).
std::vector<Hinge> bennett() {
  const double alpha = 1.1, beta = .6, a = .5, b = a * std::sin(beta) / std::sin(alpha), t1 = 1.3;
  const double t2 =
      2 * std::atan(std::sin((alpha + beta) / 2) / std::sin((beta - alpha) / 2) / std::tan(t1 / 2));
  // Denavit and Hartenberg: turn about z, go along x, twist about x.
  const double angle[] = {t1, t2, -t1, -t2}, length[] = {a, b, a, b}, skew[] = {alpha, beta, alpha, beta};
  std::vector<Hinge> hinges;
  Quat q;
  Vec3d p;
  for (int i = 0; i < 4; ++i) {
    hinges.push_back({p, q.rotate({0, 0, 1})});
    q = q * turn({0, 0, 1}, angle[i]);
    p += q.rotate({length[i], 0, 0});
    q = q * turn({1, 0, 0}, skew[i]);
  }
  if (norm(p) > 1e-12) throw std::logic_error("the Bennett linkage is open");
  return hinges;
}

// Sarrus (1853): two pairs of plates in planes at right angles carry a platform along a straight line.
std::vector<Hinge> sarrus() {
  return {{{.3, 0, 0}, {0, 1, 0}},  {{.55, 0, .2}, {0, 1, 0}}, {{.3, 0, .4}, {0, 1, 0}},
          {{0, .3, .4}, {1, 0, 0}}, {{0, .6, .2}, {1, 0, 0}},  {{0, .3, 0}, {1, 0, 0}}};
}

// On a spring that keeps it from its flat and its straight position.
Scene sprung_sarrus(const std::map<std::size_t, JointType>& loose = {}) {
  Scene scene = ring(sarrus(), 1, loose);
  add_spring(scene, "s", ground, BodyId{2}, {.15, .15, -.4}, {.15, .15, .4}, 600, 0, .86);
  return scene;
}

// ---- gears, screws

scene::Coupler gear(const std::string& name, std::uint32_t a, std::uint32_t b, double ratio,
                    scene::CouplerType type = scene::CouplerType::gear) {
  scene::Coupler coupler;
  coupler.name = name, coupler.type = type;
  coupler.joint_a = JointId{a}, coupler.joint_b = JointId{b}, coupler.ratio = ratio;
  return coupler;
}

// Three wheels that all mesh with each other by way of consistent ratios; each on two bearings.
Scene gear_ring(bool determinate) {
  Scene scene = empty();
  const Vec3d at[] = {{0, 0, 0}, {.3, 0, 0}, {.15, .4, 0}};
  std::vector<BodyId> wheel;
  for (int i = 0; i < 3; ++i)
    wheel.push_back(
        add_body(scene, "w" + std::to_string(i), 1 + i, {.02, .02, .03 + .01 * i}, at[i] + Vec3d{.01, 0, 0}));
  for (int i = 0; i < 3; ++i)
    add_joint(scene, "b" + std::to_string(i), JointType::revolute, ground, wheel[i], at[i]);
  if (!determinate)
    for (int i = 0; i < 3; ++i)
      add_joint(scene, "c" + std::to_string(i), JointType::revolute, ground, wheel[i],
                at[i] + Vec3d{0, 0, .2});
  scene.mbd->couplers.push_back(gear("g01", 0, 1, -2));
  scene.mbd->couplers.push_back(gear("g12", 1, 2, -.75));
  if (!determinate) scene.mbd->couplers.push_back(gear("g02", 0, 2, 1.5));
  twist(scene, "t", wheel[0], {0, 0, 1}, .5);
  return scene;
}

// A nut in a guide, a spindle in a bearing.
Scene screw_press(bool determinate) {
  Scene scene = empty();
  const double pitch = .02;
  const BodyId spindle = add_body(scene, "spindle", 2, {.1, .1, .01}, {.01, 0, .5}),
               nut = add_body(scene, "nut", 5, {.05, .04, .06}, {.1, .05, .4});
  add_joint(scene, "bearing", JointType::revolute, ground, spindle, {0, 0, .1});
  add_joint(scene, "guide", JointType::prismatic, ground, nut, {.3, 0, .4});
  if (determinate) {
    // The nut turns back against the spindle.
    scene.mbd->couplers.push_back(gear("thread", 0, 1, -pitch, scene::CouplerType::rack_and_pinion));
  } else {
    add_joint(scene, "thread", JointType::screw, spindle, nut, {0, 0, .4}).pitch = pitch;
  }
  twist(scene, "t", spindle, {0, 0, 1}, .4);
  return scene;
}

// ---- no redundant equations, but every element that has a direction

Scene elements() {
  Scene scene = machines::menagerie();
  scene.dem.reset();
  scene.mbd->integrator.step = 2e-3;
  const BodyId block = add_body(scene, "block", 2, {.1, .12, .2}, {.2, -1.2, .3});
  scene::Bushing bushing;
  bushing.name = "mount", bushing.body_b = block, bushing.position = {.1, -1.1, .2};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      bushing.stiffness[6 * i + j] = (i == j ? 400 + 90 * i : 20 / (1 + i + j)) * (i < 3 && j < 3 ? 1 : .2);
      bushing.damping[6 * i + j] = .01 * bushing.stiffness[6 * i + j];
    }
  scene.mbd->forces.push_back(bushing);
  push(scene, "wind", block, {.2, -1.2, .5}, {1, -2, 1}, 5);
  twist(scene, "motor", BodyId{3}, {0, 1, 1}, .02);
  std::get<scene::BodyLoad>(scene.mbd->forces.back()).follows = true;
  const BodyId a = add_body(scene, "a", 1, {.03, .04, .05}, {1, -1, 0}),
               b = add_body(scene, "b", 1, {.03, .05, .04}, {1.4, -1, .1}),
               c = add_body(scene, "c", .7, {.02, .03, .03}, {1.7, -.8, .1});
  add_joint(scene, "cardan", JointType::universal, ground, a, {.8, -1, 0}, {0, 0, 1}).axis2 = {0, 1, 0};
  add_joint(scene, "tube", JointType::cylindrical, a, b, {1.2, -1, .05}, normalized(Vec3d{1, .2, .1}));
  add_joint(scene, "plate", JointType::planar, b, c, {1.6, -.9, .1}, normalized(Vec3d{.1, .3, 1}));
  add_spring(scene, "hold", a, c, {1, -1, .2}, {1.7, -.8, .3}, 50, 1, .6);
  return scene;
}

// Ropes over several branches, a differential, a cam, stiction, and forces over coordinates elsewhere.
Scene machine_elements() {
  Scene scene = empty();
  const BodyId crank = add_body(scene, "crank", 2, {.02, .03, .04}, {.05, 0, .2}),
               left = add_body(scene, "left", 1, {.01, .02, .03}, {.6, .1, .1}),
               right = add_body(scene, "right", 1.5, {.02, .01, .03}, {-.7, -.1, .1}),
               cage = add_body(scene, "cage", .8, {.01, .01, .02}, {.1, .9, .3}),
               follower = add_body(scene, "follower", .7, {.01, .01, .01}, {.3, .5, .8}),
               block = add_body(scene, "block", 1.2, {.01, .02, .01}, {-.3, .6, .5}),
               bucket = add_body(scene, "bucket", .9, {.02, .02, .01}, {.2, .3, -.6});
  add_joint(scene, "shaft", JointType::revolute, ground, crank, {0, 0, .2}, normalized(Vec3d{.1, .2, 1}))
      .rate = 4;
  add_joint(scene, "l", JointType::revolute, ground, left, {.5, 0, .1}, normalized(Vec3d{0, .2, 1})).rate = 2;
  add_joint(scene, "r", JointType::revolute, crank, right, {-.6, 0, .1}, {0, 0, 1});
  add_joint(scene, "c", JointType::revolute, ground, cage, {.1, .8, .3}, normalized(Vec3d{.3, 0, 1}));
  add_joint(scene, "lift", JointType::prismatic, ground, follower, {.3, .5, .8}, normalized(Vec3d{0, .3, 1}));
  add_joint(scene, "rail", JointType::prismatic, cage, block, {-.3, .6, .5}, normalized(Vec3d{1, .5, 0}))
      .friction = scene::Friction{3, 0, 4};
  auto& mbd = *scene.mbd;
  scene::Coupler differential{"differential", scene::CouplerType::linear, {}, {}, 1};
  differential.terms = {{JointId{1}, scene::JointCoordinate::angle, .5},
                        {JointId{2}, scene::JointCoordinate::angle, .5},
                        {JointId{3}, scene::JointCoordinate::angle, -1}};
  scene::Coupler cam{"cam", scene::CouplerType::cam, {}, {}, 1};
  cam.terms = {{JointId{0}}, {JointId{4}}};
  cam.table = scene::CamTable{{}, {}, 2 * pi};
  for (int k = 0; k <= 24; ++k) {
    cam.table->arguments.push_back(2 * pi * k / 24);
    cam.table->values.push_back(k == 24 ? 0 : .05 * (1 - std::cos(2 * pi * k / 24)));
  }
  mbd.couplers = {differential, cam};
  mbd.forces.push_back(scene::Rope{"hoist",
                                   {{ground, {0, 0, 2}},
                                    {bucket, {.2, .3, -.5}},
                                    {left, {.7, .1, .2}},
                                    {block, {-.3, .6, .6}},
                                    {bucket, {.1, .3, -.5}},
                                    {ground, {-1, 0, 1.5}}},
                                   7.6,
                                   1500,
                                   .2});
  mbd.forces.push_back(scene::Rope{"stay", {{bucket, {.2, .2, -.6}}, {ground, {.5, -1, -1}}}, 1.3, 300, .1});
  scene::BodyLoad gas{"gas", scene::BodyLoad::Kind::force, left, {.7, .1, .1}, {0, 1, 0},
                      true,  scene::ConstantMotion{}};
  gas.over = scene::JointFunction{JointId{0}, false, {{0, 1, 2, 4, 2 * pi}, {5, 9, 2, 0, 5}}, 2 * pi};
  scene::Actuator brake{"brake", JointId{3}, scene::ConstantMotion{}};
  brake.over = scene::JointFunction{JointId{0}, true, {{-20, 0, 20}, {4, 0, -4}}, {}};
  mbd.forces.push_back(gas);
  mbd.forces.push_back(brake);
  mbd.integrator.step = 2e-3;
  return scene;
}

// Six legs of variable length carry a platform: universal joints below, prismatic ones, balls above.
Scene hexapod() {
  Scene scene = empty();
  const BodyId platform = add_body(scene, "platform", 6, {.3, .3, .5}, {.02, .01, .8});
  for (int i = 0; i < 6; ++i) {
    const double below = pi / 3 * i + (i % 2 ? -.8 : .8), above = pi / 3 * i + (i % 2 ? .25 : -.25);
    const std::string n = std::to_string(i);
    const Vec3d foot{.7 * std::cos(below), .7 * std::sin(below), 0},
        top{.4 * std::cos(above), .4 * std::sin(above), .8};
    const Vec3d d = normalized(top - foot), across = normalized(cross(d, {0, 0, 1}));
    const BodyId lower = add_rod_body(scene, "lower" + n, foot, foot + .5 * (top - foot), .8),
                 upper = add_rod_body(scene, "upper" + n, foot + .5 * (top - foot), top, .5);
    add_joint(scene, "foot" + n, JointType::universal, ground, lower, foot, across).axis2 =
        normalized(cross(d, across));
    add_joint(scene, "piston" + n, JointType::prismatic, lower, upper, foot + .5 * (top - foot), d);
    add_joint(scene, "ball" + n, JointType::spherical, upper, platform, top);
    add_spring(scene, "spring" + n, lower, upper, foot, top, 400, 5, .05 * i + norm(top - foot));
  }
  return scene;
}

}  // namespace

std::vector<ConstrainedMachine> constrained_machines() {
  using enum JointType;
  std::vector<ConstrainedMachine> list;
  const auto add = [&](const char* name, const Scene& scene, std::optional<Scene> determinate, int redundant,
                       int dof = 1) -> ConstrainedMachine& {
    return list.emplace_back(ConstrainedMachine{name, scene, std::move(determinate), .8, 0, dof, redundant});
  };
  const auto controlled = [](Scene scene) {
    scene.mbd->integrator.step.reset();
    scene.mbd->integrator.error_tolerance = 1e-7;
    return scene;
  };
  add("shaft_on_two_bearings", shaft(2), shaft(1), 5);
  add("shaft_on_three_bearings", shaft(3), shaft(1), 10);
  add("shaft_error_controlled", controlled(shaft(2)), controlled(shaft(1)), 5);
  add("door_on_two_hinges", door({revolute, revolute}), door({revolute}), 5);
  add("door_on_three_hinges", door({revolute, revolute, revolute}), door({revolute}), 10);
  add("door_on_hinge_and_pin", door({revolute, cylindrical}), door({revolute}), 4);
  add("door_error_controlled", controlled(door({revolute, revolute})), controlled(door({revolute})), 5);
  add("shaft_on_ten_bearings", shaft(10), shaft(1), 45);
  add("door_with_close_hinges", door_with_close_hinges(3), door_with_close_hinges(1), 10);
  add("welded_frame", welded_frame(true), welded_frame(false), 6);
  add("truss", truss(true), truss(false), 1, 21);
  add("two_prismatic_guides", guided({prismatic, prismatic}), guided({prismatic}), 5);
  add("three_prismatic_guides", guided({prismatic, prismatic, prismatic}), guided({prismatic}), 10);
  add("cylindrical_and_prismatic", guided({cylindrical, prismatic}), guided({prismatic}), 4);
  add("two_cylindrical_guides", guided({cylindrical, cylindrical}), guided({prismatic}), 3);
  add("bar_on_two_balls", bar_on_balls(false), bar_on_balls(true), 1);
  add("table_on_four_legs", table_on_legs(false), table_on_legs(true), 6);
  add("cardan_free", cardan(false, false), cardan(false, true), 3);
  add("cardan_driven", cardan(true, false), cardan(true, true), 3, 0);
  add("double_cardan", double_cardan(false), double_cardan(true), 1);
  add("four_bar", four_bar(false), four_bar(true), 3);
  add("four_bar_error_controlled", four_bar(false, true), four_bar(true, true), 3);
  add("small_and_large", small_and_large(false), small_and_large(true), 8, 2).smallest_loop = 2e-3;
  add("light_and_heavy", light_and_heavy(false), light_and_heavy(true), 3);
  add("parallelogram", parallelogram(false), parallelogram(true), 7);
  add("slider_crank", slider_crank(false), slider_crank(true), 3);
  add("trammel_with_second_guide", trammel(false), trammel(true), 8);
  add("wedges", wedges(), {}, 4);
  add("scissor_lift", scissor_lift(3),
      loosened(scissor_lift(3), {{"heel", universal},
                                 {"c0", spherical},
                                 {"p1", universal},
                                 {"q1", spherical},
                                 {"p2", universal},
                                 {"q2", spherical}}),
      9)
      .rounded_end = .5;
  add("bennett", ring(bennett(), 2), ring(bennett(), 2, {{1, spherical}, {2, universal}}), 3);
  add("sarrus", sprung_sarrus(), sprung_sarrus({{4, universal}}), 1);
  add("gear_ring", gear_ring(false), gear_ring(true), 16);
  add("screw_press", screw_press(false), screw_press(true), 4);
  add("hexapod", hexapod(), {}, 0, 6);
  add("elements", elements(), {}, 0, 26);
  add("machine_elements", machine_elements(), {}, 0, 10);
  return list;
}

// Triangles of contact come with the scene; mesh_contact_test.cpp moves such scenes.
bool touches_by_file(const scene::Scene& scene) {
  if (!scene.contact) return false;
  const auto from_file = [](const scene::Shape& shape) {
    const auto* hull = std::get_if<scene::HullShape>(&shape.geometry);
    return shape.use == scene::ShapeUse::contact &&
           (std::holds_alternative<scene::MeshShape>(shape.geometry) || (hull && !hull->file.empty()));
  };
  return std::ranges::any_of(scene.contact->ground, from_file) ||
         std::ranges::any_of(scene.shapes, from_file);
}

std::vector<ConstrainedMachine> shipped_machines() {
  // [s], and the longest step, where the scene's own would take too long here.
  struct Short {
    double end, step;
  };
  const std::map<std::string, Short> cut{{"chain", {.1, 1e-3}},         {"double_pendulum", {.3, 1e-3}},
                                         {"flipping_body", {2, 5e-3}},  {"four_bars", {1.5, 5e-3}},
                                         {"governor", {.5, 2.5e-3}},    {"heavy_top", {.2, 1e-3}},
                                         {"simple_pendulum", {2, .01}}, {"simple_pendulum_cut", {2, .01}},
                                         {"squeezer", {.004, 2e-5}},    {"stops", {.5, 0}},
                                         {"dead_point", {.05, 1e-3}},   {"engine", {.03, 2e-4}},
                                         {"closed_chain", {.2, 1e-3}}};
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(machines::shipped_folder()))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  std::vector<ConstrainedMachine> list;
  for (const std::string& name : names) {
    ConstrainedMachine machine{"shipped_" + name, machines::shipped(name), {}, 0, 0, -1, -1};
    if (touches_by_file(machine.scene)) continue;
    const auto found = cut.find(name);
    machine.end = std::min(found == cut.end() ? .25 : found->second.end, machine.scene.end_time);
    scene::Integrator& integrator = machine.scene.mbd->integrator;
    if (found != cut.end() && integrator.step) integrator.step = found->second.step;
    if (const auto loose = loose_joints().find(name); loose != loose_joints().end())
      // Rods of the engine may tilt about x, across the direction of its cylinders.
      machine.determinate =
          loosened(machine.scene, loose->second, name == "engine" ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0});
    if (name == "four_bars") machine.rounded_end = .6;
    list.push_back(machine);
  }
  return list;
}

}  // namespace tandem::mbd
