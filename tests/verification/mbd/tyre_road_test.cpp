// Tyres on meshes, height fields and planes of the ground.
#include <algorithm>
#include <functional>
#include <numbers>
#include <random>

#include "common/error.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/tyre_machines.hpp"

namespace tandem::mbd::tyres {
namespace {

json field(const std::string& name, double size_x, double size_y, int nx, int ny, double x, double z,
           const std::function<double(double, double)>& height) {
  json rows = json::array();
  for (int row = 0; row <= ny; ++row) {
    rows.push_back(json::array());
    for (int column = 0; column <= nx; ++column)
      rows.back().push_back(height(size_x * (1. * column / nx - .5) + x, size_y * (1. * row / ny - .5)));
  }
  return {{"name", name},
          {"material", "asphalt"},
          {"position", {x, 0, z}},
          {"shape", {{"type", "height_field"}, {"size", {size_x, size_y}}, {"heights", rows}}}};
}
json plane(const std::string& name) {
  return {{"name", name},
          {"material", "asphalt"},
          {"shape", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}};
}
json on(json scene, const json& ground) {
  json road = json::array();
  for (const json& shape : ground) road.push_back(shape["name"]);
  scene["mbd"]["contact"] = {
      {"materials", {{{"name", "asphalt"}, {"stiffness", 1e6}, {"restitution", 0.1}, {"friction", 0.8}}}},
      {"ground", ground}};
  for (json& force : scene["mbd"]["forces"])
    if (force["type"] == "tyre") force["road"] = road;
  return scene;
}

// A vehicle that brakes in a bend, on a plane by itself, as a shape, and of triangles.
TEST(TyreRoad, FlatRoadsAreThePlane) {
  Vehicle v;
  v.steer = 0.02;
  v.front.patch = v.rear.patch = 0.14;
  const json scene = v.scene(-300, 100);
  const auto end = [](const json& s) {
    TyreRun run(s);
    run.advance(0.5);
    return run.seen().bodies[0].pose.p_WB;
  };
  const Vec3d expected = end(scene);
  for (const json& ground :
       {plane("road"), field("road", 60, 20, 37, 11, 10, 0, [](double, double) { return 0; })}) {
    const double off = norm(end(on(scene, json::array({ground}))) - expected);
    std::printf("  %-14s differs by %.1e m after 10 m, tolerance 1e-9\n",
                ground["shape"]["type"].get<std::string>().c_str(), off);
    EXPECT_LT(off, 1e-9);
  }
}

// A vehicle that brakes in a bend up a ramp, which is a height field, and the same ramp from a file with the
// triangles in any order.
TEST(TyreRoad, AMeshFileIsItsHeightField) {
  Vehicle v;
  v.speed = 8, v.steer = 0.01, v.height = 0.35;
  v.front.patch = v.rear.patch = 0.14;
  const auto height = [](double x, double) { return 0.15 * (x - 3); };
  const json scene = v.scene(0, 60), ramp = field("ramp", 30, 12, 30, 3, 18, 0, height);
  json file = ramp;
  file["shape"] = {{"type", "mesh"}, {"file", "ramp.obj"}};
  TriangleMesh mesh =
      height_field_mesh(30, 12, ramp["shape"]["heights"].get<std::vector<std::vector<double>>>());
  std::mt19937_64 random(3);
  std::ranges::shuffle(mesh.triangles, random);
  const auto end = [&](const json& ground, const std::vector<NamedMesh>& meshes) {
    TyreRun run(TyreRun::scene_of(on(scene, json::array({plane("floor"), ground}))), meshes);
    run.advance(1);
    return run.seen().bodies[0].pose.p_WB;
  };
  const Vec3d expected = end(ramp, {}), seen = end(file, {{"ground/ramp", mesh}});
  std::printf("  height %.3f m; differs by %.1e m, tolerance 1e-9\n", seen.z, norm(seen - expected));
  EXPECT_GT(seen.z, 0.5);
  EXPECT_LT(norm(seen - expected), 1e-9);
}

// A wheel that is drawn slowly over a sine road: at the point of contact s the centre is at the loaded radius
// along the normal. The mean of the four points is higher by a^2 h'' / 4 than h, with a half of the patch.
TEST(TyreRoad, SlowWheelFollowsASine) {
  Rig rig;
  rig.speed = 0.25;
  const double A = 0.03, k = 2 * std::numbers::pi / 2, a = rig.tyre.patch / 2;
  const auto h = [&](double s) { return A * std::sin(k * s) * (1 - k * k * a * a / 4); };
  json scene = rig.scene(0);
  scene["mbd"]["joints"][2].erase("motion");  // rolls freely
  scene["mbd"]["joints"][2]["rate"] = rig.speed / rig.loaded_radius();
  TyreRun run(on(scene, json::array({field("road", 6, 2, 1200, 2, 2, 0,
                                           [&](double x, double) { return A * std::sin(k * x); })})));
  double worst = 0;
  for (int i = 0; i < 80; ++i) {
    run.advance(0.1);
    if (i < 8) continue;  // the start, which is in no equilibrium
    const Vec3d c = run.seen().bodies[2].pose.p_WB;
    double s = c.x, z = 0;
    for (int n = 0; n < 50; ++n) {
      const double slope = std::atan(A * k * std::cos(k * s)),
                   r = rig.tyre.radius - rig.load() / std::cos(slope) / rig.tyre.stiffness;
      s = c.x + r * std::sin(slope), z = h(s) + r * std::cos(slope);
    }
    worst = std::max(worst, std::abs(c.z - z));
  }
  std::printf("  largest difference from the closed form %.2e m, of a road of +-%.2f m, tolerance 2e-4\n",
              worst, A);
  EXPECT_LT(worst, 2e-4);
}

// Fast over a low sine: the weight on its tyre is a mass on a spring and damper with a moving foot.
TEST(TyreRoad, FastWheelAnswersASine) {
  Rig rig;
  rig.tyre.slip = rig.tyre.cornering = 10;
  const double A = 2e-3, k = 2 * std::numbers::pi / 2, a = rig.tyre.patch / 2;
  for (const double speed : {4., 7., 12.}) {
    rig.speed = speed;
    json scene = rig.scene(0);
    scene["mbd"]["joints"][2].erase("motion");
    scene["mbd"]["joints"][2]["rate"] = rig.speed / rig.loaded_radius();
    scene["mbd"]["bodies"][2]["inertia"] = {1e-3, 1e-3, 1e-3};
    const double length = 2 + 3 * speed;
    TyreRun run(
        on(scene, json::array({field("road", length, 2, static_cast<int>(100 * length), 2, length / 2 - 1, 0,
                                     [&](double x, double) { return A * std::sin(k * x); })})));
    run.advance(2);
    double low = 1, high = 0;
    for (int i = 0; i < 900; ++i) {
      run.advance(1e-3);
      const double z = run.seen().bodies[2].pose.p_WB.z;
      low = std::min(low, z), high = std::max(high, z);
    }
    const double w0 = std::sqrt(rig.tyre.stiffness / rig.mass), ratio = k * speed / w0,
                 zeta = 2000 / (2 * std::sqrt(rig.tyre.stiffness * rig.mass)), damped = 2 * zeta * ratio;
    expect_share("amplitude at " + std::to_string(ratio) + " of the natural frequency [m]", (high - low) / 2,
                 A * (1 - k * k * a * a / 4) *
                     std::sqrt((1 + damped * damped) / (std::pow(1 - ratio * ratio, 2) + damped * damped)),
                 2e-2);
    EXPECT_LT(std::abs(run.facts()["mbd_largest_energy_balance_J"].get<double>()), 1e-2 * rig.mass * g * A);
  }
}

// From a plane floor up a ramp, which is a height field. On the ramp the vehicle is slower by g sin(angle).
scene::Scene ramp_scene(bool free_wheels) {
  Vehicle v;
  v.speed = 8, v.steer = free_wheels ? 0 : 0.01;
  v.front.patch = v.rear.patch = 0.14;
  v.height = 0.35;
  const double slope = 0.15;
  const json scene = v.scene(0, free_wheels ? 0 : 60);
  return TyreRun::scene_of(
      on(scene, json::array({plane("floor"), field("ramp", 30, 12, 30, 3, 18, 0,
                                                   [=](double x, double) { return slope * (x - 3); })})));
}
TEST(TyreRoad, UpARamp) {
  TyreRun run(ramp_scene(true));
  run.advance(1.5);
  const auto speed = [&] {
    const Vec3d v = run.seen().bodies[0].twist.v_WB;
    return norm(v);
  };
  const double v0 = speed();
  run.advance(0.5);
  const double slope = std::atan(0.15), r = run["front_left_tyre.loaded_radius"];
  const Vehicle v;
  expect_share("deceleration on the ramp [m/s2]", (v0 - speed()) / 0.5,
               g * std::sin(slope) * v.all() / (v.all() + 4 * v.wheel_inertia / (r * r)), 5e-3);
}

TEST(TyreRoad, AnyFrame) {
  const scene::Scene scene = ramp_scene(false);
  const auto end = [](const scene::Scene& s) {
    TyreRun run(s);
    run.advance(0.8);
    return run.seen().bodies[0].pose.p_WB;
  };
  const Vec3d here = end(scene);
  std::mt19937_64 random(11);
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {30. * i, -2, 1});
    worst = std::max(worst, norm(motion.point_back(end(test::moved(scene, motion))) - here));
  }
  std::printf("  height %.3f m; largest deviation in three frames %.1e m of 6 m tolerance 1e-7\n", here.z,
              worst);
  EXPECT_GT(here.z, 0.5);
  EXPECT_LT(worst, 1e-7);
}

std::string refusal(const json& ground, double speed = 5) {
  Rig rig;
  rig.speed = speed;
  json scene = rig.scene(0);
  scene["mbd"]["joints"][2].erase("motion");
  try {
    TyreRun run(on(scene, ground));
    run.advance(1);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(TyreRoad, RefusesWhatItCannotRollOn) {
  const auto step = [](double height, double run, double at = 2) {
    return json::array({field("kerb", 8, 2, 800, 2, 2, 0, [=](double x, double) {
      return height * std::clamp((x - at) / run, 0., 1.);
    })});
  };
  for (const auto& [ground, words] :
       {std::pair{step(0.05, 0.01, 0.03), "comes to a step of road \"kerb\""},
        std::pair{step(0.05, 0.01), "steeper than 45 degrees"},
        std::pair{step(-0.05, 0.01), "steeper than 45 degrees"},
        std::pair{step(0.3, 0.2), "steeper than 45 degrees"},
        std::pair{json::array({field("short", 4, 2, 8, 2, 0, 0, [](double, double) { return 0; })}),
                  "has no road below it"},
        std::pair{json::array({field("high", 9, 2, 8, 2, 0, 0.5, [](double, double) { return 0; })}),
                  "has no road below it"}}) {
    const std::string what = refusal(ground);
    std::printf("  %s\n", what.c_str());
    EXPECT_NE(what.find(words), std::string::npos);
  }
  EXPECT_EQ(refusal(step(0.02, 0.1)), "");
}

TEST(TyreRoad, RefusesAWheelInItsRoadAtTheStart) {
  Rig rig;
  json scene = on(rig.scene(0), json::array({plane("road")}));
  scene["mbd"]["forces"][0]["radius"] = 1000 * rig.tyre.radius;
  std::string what;
  try {
    TyreRun run(scene);
  } catch (const Error& error) {
    what = error.what();
  }
  std::printf("  %s\n", what.c_str());
  EXPECT_NE(what.find("mbd.forces[0].radius: the centre of the wheel of tyre \"tyre\" is "),
            std::string::npos);
  EXPECT_NE(what.find("above road \"road\" at the start, less than half of the radius of "),
            std::string::npos);
}

// A wheel with a rim of that radius, on its tyre and pressed down by its weight.
json wheel_with_rim(double rim, const json& ground, const json& road) {
  Rig rig;
  rig.speed = 1;
  json scene = on(rig.scene(0), ground);
  scene["mbd"]["forces"][0]["road"] = road;
  // It comes to rest soon.
  scene["mbd"]["forces"][0]["damping"] = 2e4;
  scene["mbd"]["contact"]["materials"][0]["restitution"] = 0.8;
  if (road.empty()) scene["mbd"]["forces"][0].erase("road");
  scene["mbd"]["bodies"][2]["shapes"] = {{{"name", "rim"},
                                          {"use", "contact"},
                                          {"material", "asphalt"},
                                          {"shape", {{"type", "sphere"}, {"radius", rim}}}}};
  scene["mbd"]["contact"]["outputs"] = {{{"name", "of_rim"}, {"on", {"wheel"}}}};
  return scene;
}
json flat_field(const std::string& name) {
  return field(name, 4, 2, 8, 2, 0, 0, [](double, double) { return 0; });
}

// A rim that is smaller than its tyre, and larger than the loaded tyre, shares the load as two springs do.
TEST(TyreBottoming, ARimThatSharesTheLoadIsMarked) {
  const Rig rig;
  const double beyond = 2e-3, rim = rig.loaded_radius() + beyond;
  // Springs of the tyre and of the rim: k_t (R - z) + k_r (rim - z) = W.
  const double k_r = 1e6, load_of_rim = k_r * rig.tyre.stiffness * beyond / (rig.tyre.stiffness + k_r);
  for (const auto& [ground, road] :
       {std::pair{plane("floor"), json::array({"floor"})}, std::pair{plane("floor"), json::array()},
        std::pair{flat_field("field"), json::array({"field"})},
        std::pair{flat_field("field"), json::array()}}) {
    TyreRun run(wheel_with_rim(rim, json::array({ground}), road));
    run.advance(1);
    const json facts = run.facts();
    std::printf(
        "  %s: %s, %.3f of the time, from %.3f s on\n", road.empty() ? "plane road" : "road of a shape",
        facts["mbd_tyre_bottoming_of"].get<std::string>().c_str(),
        facts["mbd_tyre_bottoming_share"].get<double>(), facts["mbd_tyre_bottoming_at_s"].get<double>());
    expect_share("load on the rim [N]", run["of_rim.normal_force"], load_of_rim, 1e-3);
    expect_share("load on the tyre [N]", run["tyre.force.z"], rig.load() - load_of_rim, 1e-3);
    EXPECT_GT(facts["mbd_tyre_bottoming_share"].get<double>(), 0.5);
    EXPECT_LE(facts["mbd_tyre_bottoming_share"].get<double>(), 1);
    EXPECT_LT(facts["mbd_tyre_bottoming_at_s"].get<double>(), 0.1);
    EXPECT_EQ(facts["mbd_tyre_bottoming_of"], "shape \"rim\" of body \"wheel\" and tyre \"tyre\"");
  }
}

// The share is that of the time on the road: a tyre that bottoms in the middle of a run.
TEST(TyreBottoming, CountsTheTimeOfTheTyreOnTheRoad) {
  const Rig rig;
  json scene =
      wheel_with_rim(rig.loaded_radius() - 5e-3, json::array({plane("floor")}), json::array({"floor"}));
  scene["mbd"]["forces"].push_back(
      {{"name", "press"},
       {"type", "force"},
       {"body", "weight"},
       {"point", {0, 0, rig.loaded_radius()}},
       {"direction", {0, 0, -1}},
       {"size", {{"type", "table"}, {"times", {0, 0.4, 0.45, 0.65, 0.7}}, {"values", {0, 0, 4e3, 4e3, 0}}}}});
  TyreRun run(scene);
  double beside = 0;
  for (int i = 0; i < 1000; ++i) {
    run.advance(1e-3);
    beside += 1e-3 * (run["of_rim.normal_force"] > 0 && run["tyre.force.z"] > 0);
  }
  const json facts = run.facts();
  expect_share("share of the time", facts["mbd_tyre_bottoming_share"].get<double>(), beside, 2e-2);
  EXPECT_GT(beside, 0.1);
  EXPECT_LT(beside, 0.4);
  EXPECT_GT(facts["mbd_tyre_bottoming_at_s"].get<double>(), 0.4);
}

// What touches nothing, or something beside the ground of the tyre, is no bottoming.
TEST(TyreBottoming, OtherContactsAreNot) {
  const Rig rig;
  const double small = rig.loaded_radius() - 2e-3;
  const json stone{{"name", "stone"},
                   {"material", "asphalt"},
                   {"position", {0.12, 0, 0.005}},
                   {"shape", {{"type", "sphere"}, {"radius", 0.01}}}};
  const auto end = [](const json& scene, bool touches) {
    TyreRun run(scene);
    double force = 0;
    for (int i = 0; i < 100; ++i) run.advance(1e-3), force = std::max(force, run["of_rim.normal_force"]);
    const json facts = run.facts();
    std::printf("  rim bears up to %.4g N; share %g\n", force,
                facts["mbd_tyre_bottoming_share"].get<double>());
    EXPECT_EQ(force > 0, touches);
    EXPECT_EQ(facts["mbd_tyre_bottoming_share"], 0);
    EXPECT_EQ(facts["mbd_tyre_bottoming_of"], "");
  };
  const json floor = plane("floor"), of_floor = json::array({"floor"});
  end(wheel_with_rim(small, json::array({floor}), of_floor), false);
  end(wheel_with_rim(small, json::array({floor}), json::array()), false);
  end(wheel_with_rim(small, json::array({floor, stone}), of_floor), true);
  end(wheel_with_rim(small, json::array({floor, stone}), json::array()), true);
  json ignored = wheel_with_rim(rig.loaded_radius() + 2e-3, json::array({floor}), of_floor);
  ignored["mbd"]["contact"]["ignore"] = json::array({json::array({"wheel", "ground"})});
  ignored["mbd"]["contact"].erase("outputs");
  TyreRun run(ignored);
  run.advance(0.1);
  EXPECT_EQ(run.facts()["mbd_tyre_bottoming_share"], 0);
}

}  // namespace
}  // namespace tandem::mbd::tyres
