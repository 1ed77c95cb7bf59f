// Analytic derivatives against central differences of the residual, on a machine with every kind of part.
#include <gtest/gtest.h>

#include <random>

#include "mbd_server/contact/contact_force.hpp"
#include "mbd_server/forces/tyre.hpp"
#include "tests/verification/mbd/machines.hpp"

namespace tandem::mbd {
namespace {

// The residual r and the constraints phi as one vector; the elimination inverts its derivative.
struct Differences {
  scene::Scene scene;
  Model model = build_model(scene);
  MachineSystem system{model};
  State state = initial_state(model, scene);
  VectorXd x0 = VectorXd::Zero(model.freedoms);
  std::mt19937 random{7};
  int size = model.freedoms + model.equations;

  explicit Differences(const scene::Scene& s) : scene(s) {}

  VectorXd any(Eigen::Index n, double largest) {
    std::uniform_real_distribution<double> d(-largest, largest);
    return VectorXd::NullaryExpr(n, [&] { return d(random); });
  }
  // An arbitrary state that violates the constraints, except those that `close` satisfies.
  void scatter(double multipliers) {
    const VectorXd q0 = state.q;
    system.move(q0, any(model.freedoms, .5), state.q);
    state.u += any(model.freedoms, 2);
    state.udot = any(model.freedoms, 5);
    state.lambda = any(model.equations, multipliers);
    state.time = .37;
    for (Eigen::Index i = 0; i < state.loads.size(); ++i)
      state.loads.data()[i] = 3 * std::sin(1.0 + 2.0 * double(i));
  }
  VectorXd values(const State& s) {
    VectorXd all(size);
    all.head(model.freedoms) = system.residual(s);
    all.tail(model.equations) = system.constraint(Level::position);
    return all;
  }
  // Weighted derivative by central differences; the constraints count with weight 1 in x only.
  Eigen::MatrixXd differences(const MatrixWeights& w, const VectorXd& q_begin, const VectorXd& x) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
    const double e = 1e-6;
    for (int j = 0; j < model.freedoms; ++j) {
      const auto change = [&](const auto& apply) {
        State plus = state, minus = state;
        apply(plus, e), apply(minus, -e);
        return VectorXd((values(plus) - values(minus)) / (2 * e));
      };
      const VectorXd by_x = change([&](State& s, double d) {
        VectorXd moved = x;
        moved[j] += d;
        system.move(q_begin, moved, s.q);
      });
      A.col(j).head(model.freedoms) =
          w.mass * change([&](State& s, double d) { s.udot[j] += d; }).head(model.freedoms) +
          w.damping * change([&](State& s, double d) { s.u[j] += d; }).head(model.freedoms) +
          w.stiffness * by_x.head(model.freedoms);
      A.col(j).tail(model.equations) = by_x.tail(model.equations);
    }
    for (int j = 0; j < model.equations; ++j) {
      State plus = state, minus = state;
      plus.lambda[j] += 1, minus.lambda[j] -= 1;
      A.col(model.freedoms + j) = (values(plus) - values(minus)) / 2;
    }
    return A;
  }
  // Multiplies solutions by the differences and compares with the right-hand sides.
  void expect_inverse(const char* what, const MatrixWeights& weights, const VectorXd& q_begin,
                      const VectorXd& x, double tolerance = 1e-7) {
    const Eigen::MatrixXd A = differences(weights, q_begin, x);
    system.residual(state);
    system.factorise(weights, x);
    ASSERT_TRUE(system.dependent().empty());
    double worst = 0;
    for (int i = 0; i < 10; ++i) {
      const VectorXd b = any(size, 1);
      VectorXd dx(model.freedoms), dl(model.equations), all(size);
      system.solve(b.head(model.freedoms), b.tail(model.equations), dx, dl);
      all << dx, dl;
      worst = std::max(worst, (A * all - b).cwiseAbs().maxCoeff() /
                                  (A.cwiseAbs() * all.cwiseAbs()).cwiseMax(b.cwiseAbs()).maxCoeff());
    }
    std::printf("%-42s size %d  A A^-1 b - b: %8.1e  tolerance %.0e\n", what, size, worst, tolerance);
    EXPECT_LT(worst, tolerance);
  }
};

// One part of each kind in a branch each, and a spherical cut joint, a distance and a gear between branches.
scene::Scene looped() {
  scene::Scene scene = machines::menagerie();
  const BodyId loose{5}, tip{3}, drum{7}, ball{2};
  machines::add_joint(scene, "cut", scene::JointType::spherical, drum, loose, {-.4, -.1, .6}).cut = true;
  scene::Joint& rod =
      machines::add_joint(scene, "rod", scene::JointType::distance, tip, loose, {1.4, .3, .6});
  rod.child_position = Vec3d{-.4, .3, .9};
  rod.length = 1.8;
  scene.mbd->couplers.push_back({"gear", scene::CouplerType::gear, JointId{1}, JointId{5}, -1.5});
  scene.mbd->couplers.push_back({"same branch", scene::CouplerType::gear, JointId{1}, JointId{3}, .7});
  scene::Bushing bushing{"bushing", ball, drum, {.3, .1, .4}, {}, {}};
  for (int i = 0; i < 36; ++i) {
    bushing.stiffness[i] = i % 7 == 0 ? 20 : .5 * std::sin(i);
    bushing.damping[i] = i % 7 == 0 ? 1 : .1 * std::cos(i);
  }
  scene.mbd->forces.push_back(bushing);
  bushing.body_a = ground, bushing.body_b = tip;
  scene.mbd->forces.push_back(bushing);
  scene.mbd->forces.push_back(scene::BodyLoad{"push",
                                              scene::BodyLoad::Kind::force,
                                              ball,
                                              {1, .2, .3},
                                              {0, .6, .8},
                                              true,
                                              scene::ConstantMotion{3, 0}});
  scene.mbd->forces.push_back(scene::BodyLoad{
      "turn", scene::BodyLoad::Kind::torque, ball, {}, {0, .6, .8}, false, scene::ConstantMotion{2, 0}});
  scene.mbd->joints[0].limits = scene::Limits{-.1, .01, 300, .2};
  scene.mbd->joints[3].friction = scene::Friction{.4, .5};
  scene::SpringDamper law{"law", drum, tip, {-.2, -.5, .4}, {1.35, .3, .6}, 0, 0, 1};
  law.table = scene::ForceTable{{-1, 0, 1, 2}, {-20, 0, 10, 40}};
  law.damping_table = scene::ForceTable{{-5, 0, 5}, {-3, 0, 6}};
  scene.mbd->forces.push_back(law);
  return scene;
}

constexpr MatrixWeights all_weights{3, 5, 7};

TEST(IterationMatrix, OfATreeIsTheDerivative) {
  Differences d(machines::menagerie());
  d.scatter(0);
  d.expect_inverse("mass", {1, 0, 0}, d.state.q, d.x0);
  d.expect_inverse("mass and damping", {1, .3, 0}, d.state.q, d.x0);
  d.expect_inverse("mass and stiffness", {1, 0, .3}, d.state.q, d.x0);
  d.expect_inverse("all", all_weights, d.state.q, d.x0);
}

TEST(IterationMatrix, AfterALargeIncrement) {
  Differences d(machines::menagerie());
  d.scatter(0);
  const VectorXd q0 = d.state.q, x1 = d.any(d.model.freedoms, .8);
  d.system.move(q0, x1, d.state.q);
  d.expect_inverse("all, x != 0", all_weights, q0, x1);
}

TEST(IterationMatrix, OfLoopsAndConnectionsIsTheDerivative) {
  Differences d(looped());
  d.scatter(4);
  d.expect_inverse("loops, mass", {1, 0, 0}, d.state.q, d.x0);
  d.expect_inverse("loops, all", all_weights, d.state.q, d.x0);
}

// Ropes over links of several branches, couplers of three joints, cams, and forces that depend on a
// coordinate elsewhere: outboard, inboard, on another branch, on the same link.
scene::Scene with_elements() {
  scene::Scene scene = machines::menagerie();
  const BodyId slider{0}, arm{1}, tip{3}, loose{5}, drum{7};
  auto& mbd = *scene.mbd;
  mbd.forces.push_back(scene::Rope{"tour",
                                   {{ground, {-1, 0, 1}},
                                    {slider, {.2, .1, 0}},
                                    {tip, {1.3, .3, .7}},
                                    {arm, {.5, .1, .3}},
                                    {loose, {-.4, .3, .8}},
                                    {drum, {-.2, -.5, .5}},
                                    {slider, {0, -.2, .1}}},
                                   3,
                                   60,
                                   .05});
  mbd.forces.push_back(scene::Rope{"pair", {{drum, {-.1, -.6, .3}}, {tip, {1.2, .3, .5}}}, .5, 60, .1});
  mbd.forces.push_back(
      scene::Rope{"tie",
                  {{ground, {2, 1, 1}}, {tip, {1.3, .2, .6}}, {tip, {1.3, .4, .6}}, {ground, {2, -1, 1}}},
                  1,
                  80,
                  .1});
  mbd.forces.push_back(scene::Rope{"slack", {{arm, {.5, .1, .3}}, {loose, {-.4, .3, .8}}}, 50, 100, .1});
  // Drums: on another branch than the rope, on the way to it, between ground and drum only, with a prescribed
  // rotation.
  const auto wind = [&](const char* name, std::uint32_t joint, std::vector<scene::RopePoint> points) {
    scene::Rope rope{name, std::move(points), .2, 70, .08};
    rope.drum = JointId{joint};
    mbd.forces.push_back(rope);
  };
  wind("hoist", 5, {{ground, {-.5, -.6, .4}}, {ground, {-.4, -.6, 1.5}}, {tip, {1.3, .3, .7}}});
  wind("crane", 1, {{slider, {.2, .3, .2}}, {tip, {1.2, .2, .6}}, {loose, {-.4, .3, .8}}});
  wind("brake band", 5, {{ground, {-.5, -.6, .4}}, {ground, {-.4, -.6, 1.5}}});
  wind("prescribed", 4, {{ground, {.3, .4, .2}}, {arm, {.5, .1, .3}}});
  const auto over = [](std::uint32_t joint, bool rate, double factor) {
    return scene::JointFunction{
        JointId{joint}, rate, {{-6, -1, .5, 2, 7}, {-factor, 0, factor, 3 * factor, 3.5 * factor}}, {}};
  };
  const auto load = [&](const char* name, BodyId body, bool torque, bool follows, scene::JointFunction f) {
    scene::BodyLoad l{name,
                      torque ? scene::BodyLoad::Kind::torque : scene::BodyLoad::Kind::force,
                      body,
                      {.3, .2, .4},
                      {0, .6, .8},
                      follows,
                      scene::ConstantMotion{}};
    l.over = f;
    mbd.forces.push_back(l);
  };
  load("outboard", tip, false, false, over(1, false, 3));
  load("inboard", slider, false, true, over(3, false, 2));
  load("other branch", drum, true, false, over(3, true, 1));
  load("own link", arm, true, true, over(1, false, 2));
  load("own link, by rate", arm, false, false, over(1, true, 1));
  load("of a prescribed coordinate", arm, false, false, over(4, false, 1));
  const auto actuator = [&](const char* name, std::uint32_t joint, scene::JointFunction f) {
    scene::Actuator a{name, JointId{joint}, scene::ConstantMotion{}};
    a.over = f;
    mbd.forces.push_back(a);
  };
  actuator("rail over spindle", 0, over(5, false, 2));
  actuator("twist over rail", 3, over(0, true, 2));
  actuator("elbow over elbow", 1, over(1, false, 2));
  scene::Coupler sum{"sum", scene::CouplerType::linear, {}, {}, 1};
  sum.terms = {{JointId{3}, scene::JointCoordinate::angle, .7},
               {JointId{1}, scene::JointCoordinate::angle, -1.3},
               {JointId{5}, scene::JointCoordinate::angle, .4},
               {JointId{0}, scene::JointCoordinate::angle, 2}};
  mbd.couplers.push_back(sum);
  scene::Coupler cam{"cam", scene::CouplerType::cam, {}, {}, 1};
  cam.terms = {{JointId{1}}, {JointId{5}}};
  cam.table = scene::CamTable{{0, 1, 2, 3, 4, 5}, {0, .3, .9, 1.1, .4, 0}, 5.0};
  mbd.couplers.push_back(cam);
  return scene;
}

// Two bodies that touch at one point, which sticks or slides.
scene::Scene touching(scene::Geometry a, scene::Geometry b, Vec3d apart, bool hertz, double friction) {
  scene::Scene scene = machines::empty();
  scene.contact.emplace();
  scene.contact->materials = {{"stuff", 200, 0, 0, .6, friction}};
  if (hertz) scene.contact->materials[0] = {"stuff", {}, 2000, .3, .6, friction, friction};
  const auto add = [&](const char* name, Vec3d position, scene::Geometry geometry) {
    scene::Shape shape;
    shape.name = name;
    shape.use = scene::ShapeUse::contact;
    shape.body = machines::add_body(scene, name, 1, {.3, .2, .4}, position);
    shape.contact_material = 0;
    shape.geometry = std::move(geometry);
    scene.shapes.push_back(shape);
  };
  add("a", apart, std::move(a));
  add("b", {0, 0, 0}, std::move(b));
  return scene;
}

// Every pair of shapes that is near touches, with springs of friction that are stretched.
void touch_all(Differences& d) {
  d.system.residual(d.state);
  std::vector<ContactFeature> features;
  for (int b = 1; b < std::ssize(d.model.contact.shapes); ++b)
    for (int a = 0; a < b; ++a) find_features(d.model, a, b, d.system.links(), .2, -1, features);
  std::erase_if(features, [](const ContactFeature& f) { return f.kind == ContactFeature::Kind::watch; });
  d.state.contacts.clear();
  for (const ContactFeature& feature : features) {
    ContactPoint& point = d.state.contacts.emplace_back();
    point.feature = feature;
    point.mass = point.pressing_mass = .5, point.entry_rate = 3;
    point.friction.stiffness = 60, point.friction.damping = 2;
    point.friction.on_a = d.any(3, .1), point.friction.on_b = d.any(3, .3);
    // The springs of Hertz's law have become stiffer since the begin of the step.
    if (d.model.contact.laws[0].hertz) {
      point.last_depth = .02, point.friction.last_stretch = d.any(3, .3);
      point.rolling.radius = .4;
      point.rolling.stiffness = 5, point.rolling.damping = .2;
      point.rolling.on_a = d.any(3, 1), point.rolling.on_b = d.any(3, 1);
      point.rolling.last_bend = d.any(3, .3);
    }
  }
}

// More pairs than links in contact: the connections are those of links. Free bodies; and links of a machine
// with loops, far out in its branches.
TEST(IterationMatrix, OfAHeapIsTheDerivative) {
  struct Heap {
    const char* what;
    scene::Scene scene;
    std::vector<BodyId> bodies;
  };
  std::vector<Heap> heaps{{"five free balls", machines::empty(), {}},
                          {"links of a machine", looped(), {{1}, {2}, {3}, {5}, {7}}},
                          {"links of a machine and free balls", looped(), {{3}, {2}, {7}}}};
  for (const int heap : {0, 2})
    for (int i = 0; i < (heap == 0 ? 5 : 2); ++i)
      heaps[static_cast<std::size_t>(heap)].bodies.push_back(
          machines::add_body(heaps[static_cast<std::size_t>(heap)].scene, "ball" + std::to_string(i), 1 + i,
                             {.3, .2, .4}, {.3 * i, .4 * (i % 2), .2 * (i % 3)}));
  for (Heap& heap : heaps)
    for (const double friction : {.02, 50.}) {
      scene::Scene scene = heap.scene;
      scene.contact.emplace();
      scene.contact->materials = {{"stuff", 200, 0, 0, .6, friction}};
      for (const BodyId body : heap.bodies) {
        scene::Shape shape;
        shape.name = "shape" + std::to_string(body.value);
        shape.use = scene::ShapeUse::contact;
        shape.body = body;
        shape.contact_material = 0;
        shape.geometry = scene::SphereShape{1};
        scene.shapes.push_back(shape);
      }
      Differences d(scene);
      d.scatter(1);
      touch_all(d);
      ASSERT_GT(std::ssize(d.state.contacts), 6) << heap.what;
      d.expect_inverse(heap.what, all_weights, d.state.q, d.x0);
      d.expect_inverse(heap.what, {1, .3, .3}, d.state.q, d.x0);
    }
}

TEST(IterationMatrix, OfContactsIsTheDerivative) {
  struct Touching {
    const char* what;
    scene::Geometry a, b;
    Vec3d apart;  // from b to a
    bool hertz = false;
    double tolerance = 1e-7;
  };
  const scene::SphereShape ball{.5};
  const scene::BoxShape box{{1, 1.2, .8}, {}};
  const scene::CapsuleShape rod{.3, 1, {}};
  const scene::PlaneShape plane{{0, 0, 0}, {0, .6, .8}};
  const scene::HullShape hull{{{0, 0, -.5}, {.4, .1, .3}, {-.4, .2, .3}, {0, -.4, .4}}, {}, 1};
  const scene::CylinderShape wheel{.5, .4, {}, {}};
  const scene::HeightFieldShape hills{2, 2, {{0, .1, 0}, {.1, .2, .05}, {0, .1, .1}}, {}};
  for (const Touching& t :
       {Touching{"sphere on plane", ball, plane, {.1, .2, .35}},
        Touching{"the same, Hertz", ball, plane, {.1, .2, .35}, true},
        Touching{"box on plane", box, plane, {.1, .2, .3}},
        Touching{"hull on plane", hull, plane, {.1, .2, .2}},
        Touching{"capsule on plane", rod, plane, {.1, .2, .3}},
        Touching{"sphere on sphere", ball, ball, {.1, .5, .75}},
        Touching{"the same, Hertz", ball, ball, {.1, .5, .75}, true},
        Touching{"sphere on a capsule's side", ball, rod, {.3, .6, .1}},
        Touching{"sphere on a capsule's end", ball, rod, {.2, .2, 1.1}},
        Touching{"sphere on a box's face", ball, box, {.1, .2, .8}},
        Touching{"sphere on a box's edge", ball, box, {.7, .8, .1}},
        Touching{"sphere on a box's corner", ball, box, {.7, .75, .6}},
        Touching{"sphere inside a box", ball, box, {.1, .2, .3}},
        Touching{"box on box", box, box, {.1, .2, .75}}, Touching{"hull on box", hull, box, {.1, .2, .8}},
        Touching{"capsules along", rod, rod, {.5, .1, .3}},
        Touching{"capsule on box", rod, box, {.7, .2, .3}},
        Touching{"sphere on hull", ball, hull, {.1, .1, .75}},
        Touching{"cylinder on plane", wheel, plane, {.1, .2, .2}},
        Touching{"cylinder on a box's face", wheel, box, {.92, .2, .1}},
        // The gap is of first order in the depth where an edge crosses a rim obliquely (contact/rim.hpp).
        Touching{"cylinder on a box's edge", wheel, box, {.83, .93, .1}, false, 2e-5},
        Touching{"sphere on a height field", ball, hills, {.1, .1, .5}},
        Touching{"box on a height field", box, hills, {.1, .1, .42}}})
    for (const double friction : {0., .02, 50.}) {
      Differences d(touching(t.a, t.b, t.apart, t.hertz, friction));
      d.scatter(0);
      const State start = initial_state(d.model, d.scene);
      d.state.q = start.q;
      d.system.move(start.q, d.any(d.model.freedoms, .02), d.state.q);
      touch_all(d);
      bool any = false;
      for (Eigen::Index k = 0; k < std::ssize(d.state.contacts); ++k) {
        const ContactForce f = evaluate(d.model, d.state.contacts[k], d.system.links());
        any |= f.normal > 0 && f.slides == (friction > 0 && friction < 1);
      }
      EXPECT_TRUE(any) << t.what;
      d.expect_inverse(t.what, all_weights, d.state.q, d.x0, t.tolerance);
    }
}

// A cambered wheel on an inclined road that rolls and slides, whose tread's states depend on q and u within a
// step; with a tread that slides partly or as a whole, and while the wheel almost stands.
TEST(IterationMatrix, OfTyresIsTheDerivative) {
  for (const double friction : {.1, 3.}) {
    scene::Scene scene = machines::empty();
    const BodyId carrier = machines::add_body(scene, "carrier", 3, {.3, .2, .4}, {.2, .1, .6}),
                 wheel = machines::add_body(scene, "wheel", 1, {.1, .2, .1}, {0, .2, .4});
    scene::Joint& hub =
        machines::add_joint(scene, "hub", scene::JointType::revolute, carrier, wheel, {0, .2, .4});
    hub.axis = {0, .96, .28};
    scene::Tyre tyre;
    tyre.name = "tyre", tyre.joint = JointId{0};
    tyre.radius = .5, tyre.stiffness = 300, tyre.damping = 4, tyre.friction = friction;
    tyre.slip_stiffness = 6, tyre.cornering_stiffness = 4;
    tyre.relaxation_length = .2, tyre.lateral_relaxation_length = .3;
    tyre.rolling_resistance = .1, tyre.patch_length = .1;
    tyre.road_normal = {.28, 0, .96};
    scene.mbd->forces.push_back(tyre);
    Differences d(scene);
    const VectorXd q0 = d.state.q;
    d.system.move(q0, d.any(d.model.freedoms, .05), d.state.q);
    d.state.u = d.any(d.model.freedoms, 1.5);
    d.state.udot = d.any(d.model.freedoms, 5);
    for (const double weight : {0., .02}) {
      d.state.z = d.any(2, .05);
      d.state.z_known = d.state.z, d.state.z_weight = weight;
      d.system.residual(d.state);
      const TyreForce f = evaluate(*forces_of<TyreOnLink>(d.model)[0], d.state, d.system.links());
      EXPECT_GT(f.force.z(), 0);
      d.expect_inverse(weight > 0 ? "tyre within a step" : "tyre", all_weights, d.state.q, d.x0);
    }
  }
}

TEST(IterationMatrix, OfMachineElementsIsTheDerivative) {
  Differences d(with_elements());
  d.scatter(4);
  d.expect_inverse("elements, mass", {1, 0, 0}, d.state.q, d.x0, 1e-6);
  d.expect_inverse("elements, damping", {1, .3, 0}, d.state.q, d.x0);
  d.expect_inverse("elements, all", all_weights, d.state.q, d.x0);
}

// Motors and cylinders with states of first order, which depend on q and u within a step.
scene::Scene driven() {
  scene::Scene scene = machines::menagerie();
  const BodyId arm{1}, tip{3}, loose{5}, drum{7};
  const scene::Gains gains{30, 8, 2, .05, {}};
  scene::Motor motor;
  motor.name = "speed", motor.joint = JointId{1}, motor.target = scene::ConstantMotion{2, 0};
  motor.gains = gains, motor.gear_ratio = 3, motor.rotor_inertia = .01;
  motor.brake = scene::Brake{4, .5, {}, scene::ConstantMotion{.7, 0}, ""};
  scene.mbd->forces.push_back(motor);
  motor.name = "position", motor.joint = JointId{3}, motor.control = scene::MotorControl::position;
  motor.torque_speed = scene::ForceTable{{-200, 0, 200}, {400, 300, 100}};
  motor.brake.reset(), motor.gains.filter = 0;
  scene.mbd->forces.push_back(motor);
  motor.name = "limited", motor.joint = JointId{5}, motor.control = scene::MotorControl::speed;
  motor.gains = {1e3, 1e2, 0, 0, {}};
  scene.mbd->forces.push_back(motor);
  scene::Cylinder stroke;
  stroke.name = "stroke", stroke.body_a = arm, stroke.body_b = loose;
  stroke.point_a = {.5, .1, .2}, stroke.point_b = {-.4, .2, .8};
  stroke.control = scene::CylinderControl::stroke, stroke.target = scene::ConstantMotion{.2, .1};
  stroke.gains = gains, stroke.max_force = 1e3, stroke.damping = 2;
  stroke.friction = scene::Friction{3, .2}, stroke.limits = scene::Limits{-.01, .01, 200, .3};
  scene.mbd->forces.push_back(stroke);
  stroke.name = "grounded", stroke.body_a = ground, stroke.body_b = tip, stroke.max_force.reset();
  stroke.point_a = {1, 1, 1}, stroke.point_b = {1.35, .3, .6};
  scene.mbd->forces.push_back(stroke);
  scene::Cylinder oil;
  oil.name = "oil", oil.body_a = drum, oil.body_b = tip;
  oil.point_a = {-.2, -.5, .4}, oil.point_b = {1.35, .3, .6};
  oil.control = scene::CylinderControl::valve, oil.target = scene::ConstantMotion{.4, 0};
  oil.damping = 1, oil.limits = scene::Limits{-3, 3, 1e3, 0};
  scene::HydraulicData& data = oil.hydraulics.emplace();
  data.bore_area = 2e-3, data.rod_area = 5e-4, data.dead_volume = 1e-3, data.bulk_modulus = 2e5;
  data.supply_pressure = 3e4, data.valve_flow = 2e-3, data.valve_drop = 1e4, data.laminar_drop = 2e3;
  data.leakage = 1e-8, data.pressure_a = 1e4, data.pressure_b = 5e3, data.cavitation_pressure = -1e5;
  scene.mbd->forces.push_back(oil);
  oil.name = "reversed", oil.target = scene::ConstantMotion{-.6, 0};
  oil.body_a = arm, oil.body_b = loose, oil.point_a = {.6, .1, .2}, oil.point_b = {-.5, .2, .9};
  oil.hydraulics->pump_flow = 1e-4;
  scene.mbd->forces.push_back(oil);
  return scene;
}

TEST(IterationMatrix, WithStatesOfFirstOrderIsTheDerivative) {
  Differences d(driven());
  d.scatter(0);
  ASSERT_EQ(d.model.first_states.size(), 12);
  d.expect_inverse("states held", all_weights, d.state.q, d.x0);
  d.state.z += d.any(d.state.z.size(), 1).cwiseProduct(.1 * d.model.state_scale);
  for (const double weight : {1e-4, .02}) {
    d.state.z_known = d.state.z;
    d.state.z_weight = weight;
    d.expect_inverse("states of the step", all_weights, d.state.q, d.x0, 1e-6);
    // They satisfy their equation.
    d.system.residual(d.state);
    const VectorXd defect = d.system.states() - d.state.z_known - weight * d.system.state_rates();
    EXPECT_LT(d.system.state_norm(defect), 1e-11);
  }
}

// Every kind of cut joint except the screw, whose derivative has this form on the constraint only; between
// two bodies, and with the ground.
TEST(IterationMatrix, OfEveryKindOfCutJoint) {
  using scene::JointType;
  for (const JointType type :
       {JointType::fixed, JointType::revolute, JointType::prismatic, JointType::cylindrical,
        JointType::universal, JointType::planar, JointType::spherical, JointType::distance})
    for (const bool grounded : {false, true}) {
      scene::Scene scene = machines::empty();
      const BodyId a = machines::add_body(scene, "a", 2, {.1, .2, .15}, {.1, 0, 0});
      const BodyId b = machines::add_body(scene, "b", 3, {.2, .1, .15}, {.5, .2, 0});
      scene::Joint& joint =
          machines::add_joint(scene, "cut", type, grounded ? ground : a, b, {.3, .1, 0}, {0, .6, .8});
      joint.axis2 = {1, 0, 0};
      joint.child_position = Vec3d{.4, .3, .1};
      joint.length = .3;
      joint.cut = true;
      Differences d(scene);
      d.scatter(4);
      d.expect_inverse(
          ("cut joint " + std::to_string(int(type)) + (grounded ? " to the ground" : "")).c_str(),
          all_weights, d.state.q, d.x0);
    }
}

// The derivatives of the constraints along the motion.
TEST(Constraints, LevelsAreDerivativesOfEachOther) {
  using scene::JointType;
  scene::Scene scene = looped();
  const BodyId loose{5}, drum{7};
  const scene::Scene elements = with_elements();
  for (const scene::Coupler& coupler : elements.mbd->couplers) scene.mbd->couplers.push_back(coupler);
  for (const JointType type : {JointType::fixed, JointType::prismatic, JointType::universal}) {
    scene::Joint& joint = machines::add_joint(scene, "cut" + std::to_string(int(type)), type, drum, loose,
                                              {-.4, -.1, .6}, {0, .6, .8});
    joint.pitch = .2, joint.cut = true;
  }
  Differences d(scene);
  d.scatter(0);
  const auto at = [&](double dt, Level level) {
    State s = d.state;
    s.time += dt;
    s.u += dt * d.state.udot;
    d.system.move(d.state.q, dt * d.state.u + .5 * dt * dt * d.state.udot, s.q);
    d.system.residual(s);
    return VectorXd(d.system.constraint(level));
  };
  const double dt = 1e-5;
  const VectorXd v = (at(dt, Level::position) - at(-dt, Level::position)) / (2 * dt);
  const VectorXd a = (at(dt, Level::velocity) - at(-dt, Level::velocity)) / (2 * dt);
  EXPECT_LT((v - at(0, Level::velocity)).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_LT((a - at(0, Level::acceleration)).cwiseAbs().maxCoeff(), 1e-6);
}

// A system that is classified as having no velocity terms must have none.
TEST(GyroscopicTerms, AreLeftOutOnlyWhereTheyVanish) {
  scene::Scene pendulum = machines::pendulum();
  EXPECT_FALSE(build_model(pendulum).gyroscopic);
  EXPECT_TRUE(build_model(machines::heavy_top()).gyroscopic);
  EXPECT_TRUE(build_model(machines::free_body(1, {1, 2, 3}, {0, 0, 0})).gyroscopic);
  const BodyId second = machines::add_body(pendulum, "second", 1, {0, 0, 0}, {-2, 0, 0});
  machines::add_joint(pendulum, "pin2", scene::JointType::revolute, BodyId{0}, second, {-1, 0, 0});
  EXPECT_TRUE(build_model(pendulum).gyroscopic);
  scene::Scene table = machines::empty();
  const BodyId x = machines::add_body(table, "x", 1, {1, 1, 1}, {0, 0, 0});
  const BodyId y = machines::add_body(table, "y", 1, {1, 1, 1}, {0, 0, 0});
  machines::add_joint(table, "jx", scene::JointType::prismatic, ground, x, {0, 0, 0}, {1, 0, 0});
  machines::add_joint(table, "jy", scene::JointType::prismatic, x, y, {0, 0, 0}, {0, 1, 0});
  EXPECT_FALSE(build_model(table).gyroscopic);
}

}  // namespace
}  // namespace tandem::mbd
