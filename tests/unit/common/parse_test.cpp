#include "common/scene/parse.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "common/scene/document.hpp"
#include "common/scene/node.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

// Processor time of reading the names of that many bodies [s].
double time_of_names(int count) {
  std::string text = R"({"bodies": [)";
  for (int i = 0; i < count; ++i) text += R"({"name": "a_link_of_a_chain_)" + std::to_string(i) + R"("},)";
  text.back() = ']';
  text += '}';
  const std::clock_t begin = std::clock();
  const nlohmann::json document = read_document(text, "chain.json");
  const std::string origin = "chain.json";
  EXPECT_EQ(
      Node(document, "", origin).names("bodies").index("a_link_of_a_chain_" + std::to_string(count - 1)),
      count - 1);
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

TEST(Parse, FourTimesTheBodiesTakeFourTimesAsLong) {
  time_of_names(1000);
  const double few = time_of_names(20'000), many = time_of_names(80'000);
  std::printf("20,000 bodies: %.3f s, 80,000: %.3f s\n", few, many);
  EXPECT_LT(many, 10 * few) << "16 times, if the time grows with the square";
}

TEST(Parse, ReadsEveryField) {
  const Scene scene = parse(test::good_scene_text, "scene.json");
  validate(scene, "scene.json");

  EXPECT_EQ(scene.format, "1.0");
  EXPECT_EQ(scene.name, "machine");
  EXPECT_EQ(scene.description, "a crate on a slide with an arm and a ball");
  EXPECT_EQ(scene.gravity, (Vec3d{0, 0, -9.81}));
  EXPECT_EQ(scene.end_time, 0.5);
  EXPECT_EQ(scene.coupling.scheme, Scheme::mbd_first);
  EXPECT_EQ(scene.coupling.window, 1e-3);

  const Mbd& mbd = *scene.mbd;
  EXPECT_EQ(mbd.integrator.rho_inf, 0.9);
  EXPECT_EQ(mbd.integrator.step, 5e-4);
  EXPECT_EQ(mbd.integrator.tolerance, 1e-9);
  EXPECT_EQ(mbd.integrator.max_iterations, 12);
  ASSERT_EQ(mbd.bodies.size(), 4u);
  EXPECT_EQ(mbd.bodies[0].inertia, (std::array<double, 6>{1, 2, 2.5, 0.1, 0.2, 0.3}));
  EXPECT_EQ(mbd.bodies[1].inertia, (std::array<double, 6>{0.1, 0.1, 0.05, 0, 0, 0}));
  EXPECT_EQ(mbd.bodies[1].pose.p_WB, (Vec3d{1, 0, 1}));
  EXPECT_EQ(mbd.bodies[1].pose.q_WB, (Quat{0.6, 0, 0.8, 0}));
  EXPECT_EQ(mbd.bodies[3].twist.v_WB, (Vec3d{1, 2, 3}));
  EXPECT_EQ(mbd.bodies[3].twist.w_WB, (Vec3d{4, 5, 6}));
  ASSERT_EQ(mbd.joints.size(), 3u);
  EXPECT_EQ(mbd.joints[0].type, JointType::prismatic);
  EXPECT_EQ(mbd.joints[0].parent, ground);
  EXPECT_EQ(mbd.joints[0].child, BodyId{0});
  EXPECT_EQ(mbd.joints[0].rate, 0.5);
  EXPECT_EQ(mbd.joints[1].type, JointType::revolute);
  EXPECT_EQ(mbd.joints[1].parent, BodyId{0});
  EXPECT_EQ(mbd.joints[1].child, BodyId{1});
  EXPECT_EQ(mbd.joints[1].axis, (Vec3d{0, 0.6, 0.8}));
  EXPECT_EQ(std::get<TableMotion>(*mbd.joints[1].motion).values, (std::vector<double>{0, 0.5, 0}));
  EXPECT_EQ(mbd.joints[2].type, JointType::spherical);
  EXPECT_EQ(mbd.joints[2].damping, 0.2);
  const auto& spring = std::get<SpringDamper>(mbd.forces[0]);
  EXPECT_EQ(spring.body_a, ground);
  EXPECT_EQ(spring.body_b, BodyId{0});
  EXPECT_EQ(spring.point_a, (Vec3d{0, 0, 3}));
  EXPECT_EQ(spring.length, 1.5);
  EXPECT_EQ(std::get<RotationalSpringDamper>(mbd.forces[1]).joint, JointId{1});

  const Dem& dem = *scene.dem;
  EXPECT_EQ(dem.materials[1].young, 2e11);
  EXPECT_EQ(dem.pairs[1].a, MaterialId{1});
  EXPECT_EQ(dem.pairs[1].b, MaterialId{0});
  EXPECT_EQ(dem.pairs[1].restitution, 0.6);
  EXPECT_EQ(dem.contact, ContactLaw::hertz_mindlin);
  EXPECT_TRUE(dem.force_generic);
  EXPECT_EQ(dem.precision, Precision::full);
  EXPECT_EQ(dem.micro_step, 1e-5);
  EXPECT_EQ(dem.skin, 0.001);
  EXPECT_FALSE(dem.auto_step || dem.relax_start || dem.speed_limit);
  EXPECT_EQ(dem.overlap_limit, 0.05);
  EXPECT_EQ(dem.particles[0].radius_min, 0.01);
  EXPECT_EQ(dem.particles[0].radius_max, 0.012);
  EXPECT_EQ(dem.particles[0].velocity, (Vec3d{0, 0, -1}));
  const auto& fill = std::get<LatticeFill>(dem.particles[0].fill);
  EXPECT_EQ(fill.lattice, "hexagonal");
  EXPECT_EQ(fill.jitter, 0.5);
  EXPECT_EQ(fill.seed, 7u);
  EXPECT_EQ(fill.count, 100u);
  EXPECT_EQ(dem.walls[0].body, BodyId{0});
  EXPECT_EQ(dem.walls[0].pose.p_WB, (Vec3d{0, 0, 0.1}));
  EXPECT_EQ(std::get<BoxShape>(dem.walls[0].shape).open, (std::vector<std::string>{"+z"}));
  EXPECT_EQ(dem.walls[1].body, ground);
  EXPECT_EQ(std::get<PlaneShape>(dem.walls[1].shape).normal, (Vec3d{0, 0, 1}));
  EXPECT_EQ(std::get<CylinderShape>(dem.walls[2].shape).segments, 12);
  EXPECT_EQ(dem.domain.max, (Vec3d{2, 2, 3}));
  EXPECT_EQ(dem.periodic, (std::array<bool, 3>{true, false, true}));

  EXPECT_EQ(scene.output.frame_interval, 0.01);
  EXPECT_FALSE(scene.output.particles);
  EXPECT_EQ(scene.output.camera->field_of_view, 30);
  EXPECT_EQ(scene.checks[0].reduce, "mean");
  EXPECT_EQ(scene.checks[0].from, 0.4);
  EXPECT_EQ(scene.checks[0].why, "sum of m g");
  EXPECT_TRUE(scene.checks[1].absolute);
}

TEST(Parse, ReadsInletsAndOutlets) {
  nlohmann::json scene = test::good_scene();
  scene["dem"]["particles"][0]["fill"] = nlohmann::json::parse(
      R"({"type": "inlet", "min": [0, 0, 1], "max": [1, 1, 2], "mass_rate": 2.5, "start": 0.5, "count": 7, "seed": 3})");
  scene["dem"]["outlets"] = nlohmann::json::parse(R"([
    {"name": "bin", "region": {"type": "box", "min": [0, 0, 0], "max": [1, 2, 3]}},
    {"name": "drain", "region": {"type": "plane", "point": [0, 0, -1], "normal": [0, 0, -1]}}])");
  const Dem dem = *parse(scene.dump(), "scene.json").dem;
  const auto& inlet = std::get<InletFill>(dem.particles[0].fill);
  EXPECT_EQ(inlet.max, (Vec3d{1, 1, 2}));
  EXPECT_FALSE(inlet.rate);
  EXPECT_EQ(inlet.mass_rate, 2.5);
  EXPECT_EQ(inlet.start, 0.5);
  EXPECT_EQ(inlet.count, 7u);
  EXPECT_EQ(inlet.seed, 3u);
  EXPECT_EQ(std::get<Box>(dem.outlets[0].region).max, (Vec3d{1, 2, 3}));
  EXPECT_EQ(dem.outlets[1].name, "drain");
  EXPECT_EQ(std::get<HalfSpace>(dem.outlets[1].region).normal, (Vec3d{0, 0, -1}));
}

TEST(Parse, ReadsRoundWalls) {
  nlohmann::json scene = test::good_scene();
  scene["dem"]["walls"] = nlohmann::json::parse(R"([
    {"name": "bore", "material": "steel", "shape": {"type": "cylinder", "radius": 0.5}},
    {"name": "can", "material": "steel", "shape": {"type": "cylinder", "radius": 0.5, "height": 2, "open": ["+z"]}},
    {"name": "ball", "material": "steel", "shape": {"type": "sphere", "radius": 0.25}}])");
  const auto walls = parse(scene.dump(), "scene.json").dem->walls;
  const auto &bore = std::get<CylinderShape>(walls[0].shape), &can = std::get<CylinderShape>(walls[1].shape);
  EXPECT_EQ(bore.radius, 0.5);
  EXPECT_FALSE(bore.height || bore.segments || can.segments);
  EXPECT_EQ(can.height, 2);
  EXPECT_EQ(std::get<SphereShape>(walls[2].shape).radius, 0.25);
}

TEST(Parse, ReadsTheCouplingInFull) {
  const auto coupling = [](const std::string& text) {
    return parse(R"({"tandem": "1.0", "name": "a", "end_time": 1, "coupling": )" + text + "}", "scene.json")
        .coupling;
  };
  const Coupling a = coupling(R"({"scheme": "implicit", "window": 2e-4, "load": "linear", "path": "quadratic",
    "iteration": {"method": "aitken", "relaxation": 0.5, "tolerance": 1e-6, "length": 1e-8, "max_iterations": 7},
    "adaptive": {"energy_tolerance": 0.1, "path_tolerance": 1e-6, "min_window": 1e-5, "max_window": 1e-2}})");
  EXPECT_EQ(a.scheme, Scheme::implicit);
  EXPECT_EQ(a.load, LoadShape::linear);
  EXPECT_EQ(a.path, PathShape::quadratic);
  EXPECT_EQ(a.iteration->method, Acceleration::aitken);
  EXPECT_EQ(a.iteration->relaxation, 0.5);
  EXPECT_EQ(a.iteration->tolerance, 1e-6);
  EXPECT_EQ(a.iteration->length, 1e-8);
  EXPECT_EQ(a.iteration->max_iterations, 7);
  EXPECT_EQ(a.adaptive->energy_tolerance, 0.1);
  EXPECT_EQ(a.adaptive->path_tolerance, 1e-6);
  EXPECT_EQ(a.adaptive->min_window, 1e-5);
  EXPECT_EQ(a.adaptive->max_window, 1e-2);
  const Coupling b = coupling(R"({"scheme": "linear_implicit", "load": "end"})");
  EXPECT_EQ(b.scheme, Scheme::linear_implicit);
  EXPECT_EQ(b.load, LoadShape::end);
  EXPECT_EQ(coupling(R"({"scheme": "parallel"})").scheme, Scheme::parallel);
}

// Absent keys have the defaults of the model.
TEST(Parse, DefaultsAreThoseOfTheModel) {
  const Scene scene = parse(R"({"tandem": "1.0", "name": "pendulum", "end_time": 1,
    "mbd": {"bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}]}})",
                            "scene.json");
  validate(scene, "scene.json");
  EXPECT_EQ(scene.gravity, Scene{}.gravity);
  EXPECT_EQ(scene.coupling.scheme, Scheme::dem_first);
  EXPECT_EQ(scene.coupling.window, Coupling{}.window);
  EXPECT_EQ(scene.coupling.load, LoadShape::mean);
  EXPECT_EQ(scene.coupling.path, PathShape::linear);
  EXPECT_FALSE(scene.coupling.iteration || scene.coupling.adaptive);
  EXPECT_EQ(scene.mbd->integrator.rho_inf, Integrator{}.rho_inf);
  EXPECT_FALSE(scene.mbd->integrator.step);
  EXPECT_EQ(scene.mbd->bodies[0].pose.q_WB, Quat{});
  EXPECT_FALSE(scene.dem);
  EXPECT_FALSE(scene.output.camera);
}

TEST(Parse, ExplicitMethodHasAnErrorControl) {
  const auto integrator = [](const std::string& settings) {
    return parse(R"({"tandem": "1.0", "name": "m", "end_time": 1, "mbd": {"integrator": )" + settings +
                     R"(, "bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1]}]}})",
                 "scene.json")
        .mbd->integrator;
  };
  EXPECT_EQ(integrator("{}").method, IntegrationMethod::generalized_alpha);
  EXPECT_FALSE(integrator("{}").error_tolerance);
  const Integrator usual = integrator(R"({"method": "dormand_prince"})");
  EXPECT_EQ(usual.method, IntegrationMethod::dormand_prince);
  EXPECT_EQ(usual.error_tolerance, 1e-6);
  EXPECT_EQ(integrator(R"({"method": "dormand_prince", "error_tolerance": 1e-8})").error_tolerance, 1e-8);
}

TEST(Parse, ReadsJointsCouplersAndForcesInFull) {
  const Scene scene = parse(R"({"tandem": "1.0", "name": "machine", "end_time": 1, "mbd": {
    "integrator": {"formulation": "index3", "error_tolerance": 1e-7, "min_step": 1e-9, "assembly_tolerance": 1e-3},
    "bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1]}, {"name": "b", "mass": 1, "inertia": [1, 1, 1]},
               {"name": "c", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [
      {"name": "turn", "type": "revolute", "child": "a", "position": [0, 0, 0], "axis": [0, 0, 1],
       "limits": {"lower": -1, "upper": 2, "stiffness": 3, "damping": 4}, "friction": {"force": 5, "slip": 6}},
      {"name": "slide", "type": "prismatic", "child": "b", "position": [0, 0, 0], "axis": [1, 0, 0],
       "limits": {"lower": 0, "upper": 1, "stiffness": 2, "restitution": 0.5}},
      {"name": "cross", "type": "universal", "child": "c", "position": [0, 0, 0], "axis": [1, 0, 0], "axis2": [0, 1, 0]},
      {"name": "thread", "type": "screw", "parent": "a", "child": "c", "position": [0, 0, 0], "child_position": [0, 0, 1],
       "axis": [0, 0, 1], "pitch": 0.1, "cut": true},
      {"name": "rod", "type": "distance", "parent": "a", "child": "b", "position": [0, 0, 0],
       "child_position": [1, 0, 0], "length": 2},
      {"name": "plane", "type": "planar", "child": "c", "position": [0, 0, 0], "axis": [0, 0, 1], "cut": true},
      {"name": "tube", "type": "cylindrical", "child": "c", "position": [0, 0, 0], "axis": [0, 0, 1], "cut": true}],
    "couplers": [{"name": "rack", "type": "rack_and_pinion", "joint_a": "turn", "joint_b": "slide", "ratio": 0.2}],
    "forces": [
      {"name": "law", "type": "spring_damper", "body_b": "b", "point_a": [0, 0, 0], "point_b": [1, 0, 0], "length": 1,
       "table": {"arguments": [0, 1], "values": [2, 3]}, "damping_table": {"arguments": [-1, 1], "values": [-4, 4]}},
      {"name": "mount", "type": "bushing", "body_a": "a", "body_b": "b", "position": [1, 2, 3],
       "stiffness": [1, 2, 3, 4, 5, 6],
       "damping": [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26,
                   27, 28, 29, 30, 31, 32, 33, 34, 35]},
      {"name": "push", "type": "force", "body": "a", "point": [1, 0, 0], "direction": [0, 1, 0], "follows": true,
       "size": {"type": "constant", "value": 7}},
      {"name": "wring", "type": "torque", "body": "b", "direction": [0, 0, 1], "size": {"type": "constant", "rate": 8}},
      {"name": "motor", "type": "actuator", "joint": "turn", "input": "u"}],
    "sensors": ["turn.q", "b.position.x"]}})",
                            "scene.json");
  validate(scene, "scene.json");
  const Mbd& mbd = *scene.mbd;
  EXPECT_EQ(mbd.integrator.formulation, Formulation::index3);
  EXPECT_EQ(mbd.integrator.error_tolerance, 1e-7);
  EXPECT_EQ(mbd.integrator.min_step, 1e-9);
  EXPECT_EQ(mbd.integrator.assembly_tolerance, 1e-3);
  EXPECT_EQ(mbd.joints[0].limits->upper, 2);
  EXPECT_EQ(mbd.joints[0].limits->damping, 4);
  EXPECT_FALSE(mbd.joints[0].limits->restitution);
  EXPECT_EQ(mbd.joints[1].limits->restitution, 0.5);
  EXPECT_EQ(mbd.joints[0].friction->slip, 6);
  EXPECT_EQ(mbd.joints[2].axis2, (Vec3d{0, 1, 0}));
  EXPECT_EQ(mbd.joints[3].type, JointType::screw);
  EXPECT_EQ(mbd.joints[3].pitch, .1);
  EXPECT_TRUE(mbd.joints[3].cut);
  EXPECT_EQ(mbd.joints[3].child_position, (Vec3d{0, 0, 1}));
  EXPECT_EQ(mbd.joints[4].length, 2);
  EXPECT_EQ(mbd.joints[5].type, JointType::planar);
  EXPECT_EQ(mbd.joints[6].type, JointType::cylindrical);
  EXPECT_EQ(mbd.couplers[0].type, CouplerType::rack_and_pinion);
  EXPECT_EQ(mbd.couplers[0].joint_b, JointId{1});
  EXPECT_EQ(mbd.couplers[0].ratio, .2);
  const auto& law = std::get<SpringDamper>(mbd.forces[0]);
  EXPECT_EQ(law.table->values, (std::vector<double>{2, 3}));
  EXPECT_EQ(law.damping_table->arguments, (std::vector<double>{-1, 1}));
  const auto& mount = std::get<Bushing>(mbd.forces[1]);
  EXPECT_EQ(mount.stiffness[0], 1);
  EXPECT_EQ(mount.stiffness[35], 6);
  EXPECT_EQ(mount.stiffness[1], 0);
  EXPECT_EQ(mount.damping[13], 13);
  const auto& push = std::get<BodyLoad>(mbd.forces[2]);
  EXPECT_EQ(push.kind, BodyLoad::Kind::force);
  EXPECT_TRUE(push.follows);
  EXPECT_EQ(std::get<ConstantMotion>(push.size).value, 7);
  EXPECT_EQ(std::get<BodyLoad>(mbd.forces[3]).kind, BodyLoad::Kind::torque);
  EXPECT_EQ(std::get<Actuator>(mbd.forces[4]).input, "u");
  EXPECT_EQ(mbd.sensors, (std::vector<std::string>{"turn.q", "b.position.x"}));
}

TEST(Parse, EveryMotion) {
  auto json = test::good_scene();
  auto& motion = json["mbd"]["joints"][1]["motion"];
  const auto read = [&] { return *parse(json.dump(), "scene.json").mbd->joints[1].motion; };
  motion = {{"type", "constant"}, {"value", 1}, {"rate", 2}};
  EXPECT_EQ(std::get<ConstantMotion>(read()).rate, 2);
  motion = {{"type", "ramp"}, {"from", 1}, {"to", 2}, {"start", 3}, {"duration", 4}};
  EXPECT_EQ(std::get<RampMotion>(read()).duration, 4);
  EXPECT_EQ(std::get<RampMotion>(read()).of, MotionOf::position);
  motion = {{"type", "ramp"}, {"of", "speed"}, {"to", 2}, {"duration", 4}, {"offset", 5}};
  EXPECT_EQ(std::get<RampMotion>(read()).of, MotionOf::speed);
  EXPECT_EQ(std::get<RampMotion>(read()).offset, 5);
  motion = {{"type", "table"},           {"of", "speed"},    {"times", {0, 1}}, {"values", {2, 3}},
            {"interpolation", "linear"}, {"smoothing", 0.5}, {"offset", 6}};
  EXPECT_EQ(std::get<TableMotion>(read()).of, MotionOf::speed);
  EXPECT_EQ(std::get<TableMotion>(read()).interpolation, Interpolation::linear);
  EXPECT_EQ(std::get<TableMotion>(read()).smoothing, 0.5);
  EXPECT_EQ(std::get<TableMotion>(read()).offset, 6);
  motion = {{"type", "harmonic"}, {"offset", 1}, {"amplitude", 2}, {"frequency", 3}, {"phase", 4}};
  EXPECT_EQ(std::get<HarmonicMotion>(read()).phase, 4);
}

// In format 1.0 a table without another setting is a natural spline.
TEST(Parse, TheFormatDecidesHowTablesAreInterpolated) {
  auto json = test::good_scene();
  json["mbd"]["forces"][1] = {{"name", "motor"},
                              {"type", "actuator"},
                              {"joint", "slide"},
                              {"size", {{"type", "table"}, {"times", {0, 1}}, {"values", {2, 3}}}}};
  const auto read = [&] {
    const Mbd mbd = *parse(json.dump(), "scene.json").mbd;
    const auto in_joint = std::get<TableMotion>(*mbd.joints[1].motion).interpolation;
    EXPECT_EQ(std::get<TableMotion>(std::get<Actuator>(mbd.forces[1]).size).interpolation, in_joint);
    return in_joint;
  };
  EXPECT_EQ(read(), Interpolation::spline);
  json["tandem"] = "1.1";
  EXPECT_EQ(read(), Interpolation::monotone);
  for (const char* format : {"1.0", "1.1"}) {
    json["tandem"] = format;
    json["mbd"]["joints"][1]["motion"]["interpolation"] = "step";
    json["mbd"]["forces"][1]["size"]["interpolation"] = "step";
    EXPECT_EQ(read(), Interpolation::step);
  }
}

TEST(Parse, FilesAndSingleRadius) {
  auto json = test::good_scene();
  json["dem"]["particles"][0]["radius"] = 0.02;
  json["dem"]["particles"][0]["fill"] = {{"type", "file"}, {"file", "grains.csv"}};
  json["dem"]["walls"][0]["shape"] = {{"type", "mesh"}, {"file", "crate.stl"}, {"scale", 1e-3}};
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_EQ(scene.dem->particles[0].radius_min, 0.02);
  EXPECT_EQ(scene.dem->particles[0].radius_max, 0.02);
  EXPECT_EQ(std::get<FileFill>(scene.dem->particles[0].fill).file, "grains.csv");
  EXPECT_EQ(std::get<MeshShape>(scene.dem->walls[0].shape).scale, 1e-3);
  EXPECT_EQ(std::get<MeshShape>(scene.dem->walls[0].shape).stretch, (Vec3d{1, 1, 1}));
}

TEST(Parse, RoundedDirectionsBecomeUnit) {
  auto json = test::good_scene();
  json["mbd"]["joints"][1]["axis"] = {0.70710678, 0, 0.70710678};
  json["mbd"]["bodies"][0]["orientation"] = {0.70710678, 0.70710678, 0, 0};
  const Scene scene = parse(json.dump(), "scene.json");
  validate(scene, "scene.json");
  EXPECT_NEAR(norm(scene.mbd->joints[1].axis), 1, 1e-15);
  EXPECT_NEAR(scene.mbd->bodies[0].pose.q_WB.norm2(), 1, 1e-15);
}

TEST(Parse, LargeSeedKeepsItsBits) {
  auto json = test::good_scene();
  json["dem"]["particles"][0]["fill"]["seed"] = 9007199254740992u;
  const Scene scene = parse(json.dump(), "scene.json");
  EXPECT_EQ(std::get<LatticeFill>(scene.dem->particles[0].fill).seed, 9007199254740992u);
}

TEST(Parse, WholeNumbersThatNoInt64HoldsAreNumbers) {
  nlohmann::json scene = test::good_scene();
  scene["checks"][0]["tolerance"] = 9223372036854775808u;
  EXPECT_EQ(parse(scene.dump(), "scene.json").checks[0].tolerance, 0x1p63);
}

// Two adjacent bricks, and one on a floor, are not a fault: the normals of their faces are opposite.
TEST(Validate, WallsMayTouch) {
  auto json = test::good_scene();
  const auto brick = [](const char* name, double x) {
    return nlohmann::json{{"name", name},
                          {"material", "steel"},
                          {"position", {x, 1, 0.5}},
                          {"shape", {{"type", "box"}, {"size", {1, 1, 1}}}}};
  };
  json["dem"]["walls"].push_back(brick("left", 0));
  json["dem"]["walls"].push_back(brick("right", 1));
  EXPECT_NO_THROW(validate(parse(json.dump(), "scene.json"), "scene.json"));
}

nlohmann::json scene_with_materials(const char* law, nlohmann::json glass, nlohmann::json steel,
                                    nlohmann::json pairs) {
  nlohmann::json scene = test::good_scene();
  nlohmann::json& dem = scene["dem"];
  dem["contact"] = law;
  dem["materials"][0].update(glass);
  dem["materials"][1].update(steel);
  dem["pairs"] = pairs;
  return scene;
}

const Pair& pair_of(const Scene& scene, std::uint32_t a, std::uint32_t b) {
  for (const Pair& p : scene.dem->pairs)
    if ((p.a.value == a && p.b.value == b) || (p.a.value == b && p.b.value == a)) return p;
  throw std::runtime_error("no such pair");
}

TEST(Pairs, FollowFromTheirMaterials) {
  const Scene scene =
      parse(scene_with_materials("jkr", {{"restitution", 0.9}, {"friction", 0.2}, {"surface_energy", 0.04}},
                                 {{"restitution", 0.4}, {"friction", 0.8}, {"surface_energy", 0.09}},
                                 nlohmann::json::array())
                .dump(),
            "scene.json");
  validate(scene, "scene.json");
  ASSERT_EQ(scene.dem->pairs.size(), 3u);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 0).restitution, 0.9);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 0).work_of_adhesion, 0.08);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).restitution, 0.6);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).friction, 0.4);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).work_of_adhesion, 0.12);
}

TEST(Pairs, GivenConstantsOverrideThoseOfTheMaterials) {
  const Scene scene = parse(
      scene_with_materials("hooke", {{"restitution", 0.9}, {"friction", 0.2}, {"spring_stiffness", 2000}},
                           {{"restitution", 0.4}, {"friction", 0.8}, {"spring_stiffness", 6000}},
                           {{{"a", "steel"}, {"b", "glass"}, {"friction", 0.1}}})
          .dump(),
      "scene.json");
  EXPECT_EQ(pair_of(scene, 0, 1).friction, 0.1);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).restitution, 0.6);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).spring_stiffness, 3000);
  EXPECT_DOUBLE_EQ(pair_of(scene, 0, 1).spring_ratio, 2.0 / 7.0);
}

}  // namespace
}  // namespace tandem::scene
