// Bodies on triangle meshes and height fields, against planes, boxes and closed forms.
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <numbers>

#include "tests/support/rigid_motion.hpp"
#include "tests/verification/mbd/mesh_scenes.hpp"

namespace tandem::mbd::contacts {
namespace {

// The same motion on triangles as on the plane.
TEST(MeshContact, ATriangulatedPlaneIsAPlane) {
  enum Body { ball, box, rod, hull };
  for (const Body kind : {ball, box, rod, hull}) {
    const auto motion = [&](bool mesh) {
      MeshScene s;
      if (mesh)
        s.add_ground_mesh("floor", irregular_plane(8, 80));
      else
        s.add_floor();
      BodyId body{};
      if (kind == ball) body = s.add_ball("body", 1, 0.1, {0.013, 0.021, 0.12});
      if (kind == box) body = s.add_box("body", 1, {0.3, 0.2, 0.1}, {0.013, 0.021, 0.06});
      if (kind == rod)
        body = s.add("body", 1, {5e-3, 5e-3, 2e-3}, {0.013, 0.021, 0.07}, scene::CapsuleShape{.05, .3, {}}),
        s.body(body).pose.q_WB = exp(Vec3d{0, std::numbers::pi / 2, 0});
      if (kind == hull)
        body =
            s.add("body", 1, {4e-3, 4e-3, 4e-3}, {0.013, 0.021, 0.1},
                  scene::HullShape{{{-.1, -.1, -.08}, {.1, -.1, -.08}, {0, .12, -.08}, {0, 0, .14}}, {}, 1});
      s.body(body).twist.v_WB = {1.5, 0.7, 0};
      s.material() = {"stuff", 1e5, 0, 0, 0.3, 0.2};
      ContactRun run = s.run(1e-3);
      std::vector<Vec3d> path;
      for (int i = 0; i < 8; ++i) {
        run.advance(50);
        path.push_back(run.position()), path.push_back(run.spin());
      }
      std::printf("  %s steps\n", run.facts().at("mbd_steps").dump().c_str());
      return path;
    };
    const std::vector<Vec3d> on_plane = motion(false), on_mesh = motion(true);
    double worst = 0;
    for (std::size_t i = 0; i < on_plane.size(); ++i) worst = std::max(worst, norm(on_plane[i] - on_mesh[i]));
    const char* names[] = {"ball", "box", "capsule", "hull"};
    expect_near(std::string(names[kind]) + ": largest deviation of position [m] and spin [rad/s]", worst, 0,
                1e-8);
  }
}

// A ball that rolls at the bottom of a bowl of radius R: T = 2 pi sqrt(7/5 (R - r) / g) (1 + a^2 / 16).
TEST(MeshContact, ABallOscillatesInABowl) {
  const double R = 1, r = 0.1, amplitude = 0.1;
  for (const int n : {50, 100}) {
    MeshScene s;
    s.add_ground("bowl", field(0.5, 0.1, n, n / 5,
                               [&](double x, double y) { return R - std::sqrt(R * R - x * x - y * y); }));
    s.add_ball("ball", 1, r, {(R - r) * std::sin(amplitude), 0, R - (R - r) * std::cos(amplitude)});
    s.material() = {"stuff", 1e6, 0, 0, 0.1, 1};
    ContactRun run = s.run(1e-3);
    double last = run.position().x, crossings = 0, first = 0, latest = 0;
    for (int i = 1; i <= 4300; ++i) {
      run.advance(1);
      const double x = run.position().x;
      if (last < 0 && x >= 0) {
        latest = i * 1e-3 - 1e-3 * x / (x - last);
        if (crossings++ == 0) first = latest;
      }
      last = x;
    }
    const double expected =
        2 * std::numbers::pi * std::sqrt(1.4 * (R - r) / g) * (1 + amplitude * amplitude / 16);
    expect_near("period in cells of " + std::to_string(0.5 / n) + " m [s]",
                (latest - first) / (crossings - 1), expected, 0.01 * expected);
    std::printf("  %s steps, %s contacts, amplitude now %.4f\n", run.facts().at("mbd_steps").dump().c_str(),
                run.facts().at("mbd_body_contacts").dump().c_str(), run.position().x);
    expect_energy(run, 1e-9);
  }
}

// A ball that is pressed into the corner of a closed mesh touches its three faces.
TEST(MeshContact, ABallRestsInAConcaveCorner) {
  MeshScene s({-3, -4, -9});
  TriangleMesh corner;
  corner.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {2, 0, 2}, {0, 0, 2}, {0, 2, 2}};
  corner.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 5, 4}, {0, 4, 1}, {0, 3, 6}, {0, 6, 5}};
  s.add_ground_mesh("corner", corner);
  s.add_ball("ball", 1, 0.1, {0.101, 0.102, 0.103});
  const double k = 1e5;
  s.material() = {"stuff", k, 0, 0, 0.2, 0};
  ContactRun run = s.run(1e-2);
  run.advance(200);
  expect_near("x [m]", run.position().x, 0.1 - 3 / k, 1e-8);
  expect_near("y [m]", run.position().y, 0.1 - 4 / k, 1e-8);
  expect_near("z [m]", run.position().z, 0.1 - 9 / k, 1e-8);
}

// A box that overhangs a pedestal stands on two of its corners and on two crossings of edges.
TEST(MeshContact, ABoxOverhangsAPedestal) {
  const double k = 1e5;
  for (const bool mesh : {false, true}) {
    MeshScene s;
    if (mesh)
      s.add_ground_mesh("pedestal", box_mesh({1, 1, 1}));
    else
      s.add_ground("pedestal", scene::BoxShape{{1, 1, 1}, {}});
    s.add_box("box", 1, {0.4, 0.3, 0.1}, {0.4, 0.1, 0.55});
    s.material() = {"stuff", k, 0, 0, 0.2, 0.5};
    ContactRun run = s.run(1e-2);
    run.advance(200);
    std::printf("  %s: z %.9f, %s points\n", mesh ? "mesh" : "box", run.position().z,
                run.facts().at("mbd_body_contacts").dump().c_str());
    // Points at x = 0.2 and 0.5: the inner pair bears a third of the weight.
    const double inner = g / 6 / k, outer = g / 3 / k;
    expect_near("height at its middle [m]", run.position().z, 0.55 - inner - (outer - inner) * 0.2 / 0.3,
                1e-7);
    const Vec3d rest = run.position();
    run.advance(100);
    expect_near("displacement in 1 s [m]", norm(run.position() - rest), 0, 1e-8);
  }
}

// A rod that lies across a pedestal stands on its edges, and on its end where that is above the pedestal,
// with the depths of a balance of moments, though it slopes to one side.
TEST(MeshContact, ARodLiesAcrossAPedestal) {
  const double k = 1e5, r = 0.05;
  enum class Kind { mesh, box, hull };
  for (const Kind kind : {Kind::mesh, Kind::box, Kind::hull})
    for (const double left : {-0.1, -0.8}) {
      MeshScene s;
      const Vec3d size{0.3 - left, 0.5, 0.2};
      if (kind == Kind::mesh) s.add_ground_mesh("pedestal", box_mesh(size));
      if (kind == Kind::box) s.add_ground("pedestal", scene::BoxShape{size, {}});
      if (kind == Kind::hull) s.add_ground("pedestal", scene::HullShape{box_mesh(size).vertices, {}, 1});
      // Along x, with its middle at the distances -left and 0.3 from the edges.
      const BodyId rod = s.add("rod", 1, {0.04, 0.04, 0.001}, {-(0.3 + left) / 2, 0.01, 0.1 + r},
                               scene::CapsuleShape{r, 0.7, {}});
      s.body(rod).pose.q_WB = {std::sqrt(0.5), 0, std::sqrt(0.5), 0};
      s.material() = {"stuff", k, 0, 0, 0.2, 0.5};
      ContactRun run = s.run(1e-2);
      run.advance(200);
      // Points at -a and 0.3 from the middle of the rod.
      const double a = std::min(-left, 0.35), right = g * a / (a + 0.3) / k, other = g / k - right;
      expect_near("height at its middle [m]", run.position().z,
                  0.1 + r - right - (other - right) * 0.3 / (a + 0.3), 1e-7);
      expect_near("points that came into contact", run.facts().at("mbd_body_contacts"), 2, 0);
      const Vec3d rest = run.position();
      run.advance(100);
      expect_near("displacement in 1 s [m]", norm(run.position() - rest), 0, 1e-8);
    }
}

// A rod lies in the gap between two blocks, on four of their corners, along their edges.
TEST(MeshContact, ARodLiesInAGap) {
  const double k = 1e5, r = 0.05, half = 0.02, left = -0.1, right = 0.2;
  for (const bool mesh : {false, true}) {
    MeshScene s;
    for (const double side : {-1., 1.}) {
      const std::string name = side < 0 ? "left" : "right";
      const Vec3d size{right - left, 0.2, 0.2};
      if (mesh)
        s.add_ground_mesh(name, box_mesh(size));
      else
        s.add_ground(name, scene::BoxShape{size, {}});
      s.scene.contact->ground.back().pose.p_WB = {(left + right) / 2, side * (half + 0.1), -0.1};
    }
    const double height = std::sqrt(r * r - half * half);
    const BodyId rod = s.add("rod", 1, {0.04, 0.04, 0.001}, {0, 0, height}, scene::CapsuleShape{r, 0.7, {}});
    s.body(rod).pose.q_WB = {std::sqrt(0.5), 0, std::sqrt(0.5), 0};
    s.material() = {"stuff", k, 0, 0, 0.2, 0};
    ContactRun run = s.run(1e-2);
    run.advance(200);
    // Each corner bears half of the load at its end, along the normal; c: cosine of its angle. The rod slides
    // a little along the gap, which it slopes down.
    const double c = height / r, sink = g / (2 * k * c * c),
                 share = (right - run.position().x) / (right - left);
    expect_near("height at its middle [m]", run.position().z,
                height - sink * (share * share + (1 - share) * (1 - share)), 2e-8);
    expect_near("points that came into contact", run.facts().at("mbd_body_contacts"), 4, 0);
  }
}

// The centre of a wheel that is drawn over a step goes around its edge.
TEST(MeshContact, TheAxleOfAWheelGoesAroundTheEdgeOfAStep) {
  const double R = 0.3, step = 0.06, k = 1e7;
  MeshScene s;
  TriangleMesh road = box_mesh({2, 1, 1});
  for (Vec3d& p : road.vertices) p = p + Vec3d{-1, 0, -0.5};
  TriangleMesh kerb = box_mesh({2, 1, 1});
  for (Vec3d& p : kerb.vertices) p = p + Vec3d{1, 0, step - 0.5};
  s.add_ground_mesh("road", road);
  s.add_ground_mesh("kerb", kerb);
  const BodyId wheel = s.add_ball("wheel", 2, R, {-0.6, 0, R});
  s.body(wheel).twist = {{3, 0, 0}, {0, 3 / R, 0}};
  s.material() = {"stuff", k, 0, 0, 0.01, 5};
  ContactRun run = s.run(1e-3);
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    run.advance(1);
    const Vec3d p = run.position();
    double distance = p.z - R;  // of the wheel to road or kerb
    if (p.x > -std::sqrt(R * R - (R - step) * (R - step)))
      distance = (p.x < 0 ? std::hypot(p.x, p.z - step) : p.z - step) - R;
    if (p.x > -0.01 && p.x < 0.3) continue;  // it may jump there
    worst = std::max(worst, -distance);
  }
  std::printf("  at x = %.3f, z = %.4f after 0.4 s\n", run.position().x, run.position().z);
  // Half of the mass times the rate squared against the edge, as the depth of a spring.
  const double normal_rate = 3 * std::sqrt(1 - std::pow(1 - step / R, 2));
  expect_near("deepest [m]", worst, 0, 1.05 * std::sqrt(2 / k) * normal_rate);
  EXPECT_GT(run.position().x, 0.1);
  EXPECT_NEAR(run.position().z, R + step, 0.15);
  expect_energy(run, 1e-9);
}

TEST(MeshContact, AFastBallMeetsAThinMesh) {
  const auto scene = [](double stiffness, double height) {
    MeshScene s({0, 0, 0});
    s.material() = {"stuff", stiffness, 0, 0, 1, 0};
    s.add_mesh("plate", 1, {0.02, 0.02, 0.04}, {0, 0, 0}, box_mesh({0.5, 0.5, 0.004}));
    const BodyId ball = s.add_ball("ball", 1e-3, 0.005, {0.01, 0.02, height});
    s.body(ball).twist.v_WB = {0, 0, -100};
    return s;
  };
  for (const double height : {0.3, 0.7, 0.913, 1.31}) {
    ContactRun run = scene(1e8, height).run(1e-2);
    run.advance(2);
    const Vec3d v = run.velocity(1) + 1e3 * run.velocity(0);
    expect_near("momentum over the mass of the ball [m/s]", v.z, -100, 1e-6);
    EXPECT_GT(run.velocity(1).z, 90);
  }
  EXPECT_NE(refusal_of(scene(1e4, 0.7), 2, 1e-2).find("pass through each other"), std::string::npos)
      << refusal_of(scene(1e4, 0.7), 2, 1e-2);
}

// Shapes of all kinds that hit a mesh which nothing holds: momentum stays, energy falls.
TEST(MeshContact, EveryShapeCollidesWithAMesh) {
  const std::vector<std::pair<const char*, scene::Geometry>> shapes{
      {"sphere", scene::SphereShape{.1}},
      {"box", scene::BoxShape{{.2, .24, .16}, {}}},
      {"capsule", scene::CapsuleShape{.06, .2, {}}},
      {"hull", scene::HullShape{
                   {{0, 0, -.1}, {.1, .03, .06}, {-.1, .04, .06}, {0, -.1, .08}, {.02, .05, .12}}, {}, 1}}};
  for (const bool ball : {false, true})
    for (const auto& [name, shape] : shapes) {
      double worst = 0, largest = -1;
      int touched = 0;
      for (int i = 0; i < 6; ++i) {
        MeshScene s({0, 0, 0});
        const BodyId a = s.add("a", 1, {4e-3, 5e-3, 6e-3}, {-.5, .02 * (i % 3), .03 * (i % 2)}, shape);
        const BodyId b = s.add_mesh("b", 2, {8e-3, 9e-3, 7e-3}, {0, 0, 0},
                                    ball ? sphere_mesh(.12, 12) : box_mesh({.2, .2, .2}));
        std::mt19937_64 random(static_cast<std::uint64_t>(i));
        s.body(a).pose.q_WB = test::random_rotation(random);
        s.body(b).pose.q_WB = test::random_rotation(random);
        s.body(a).twist.v_WB = {2, 0, 0};
        s.material() = {"stuff", 1e6, 0, 0, 0.6, 0.3};
        ContactRun run = s.run(2e-3);
        run.advance(250);
        worst = std::max(worst, norm(run.velocity(0) + 2 * run.velocity(1) - Vec3d{2, 0, 0}));
        largest = std::max(largest, (run.largest_energy - run.start_energy) / run.start_energy);
        touched += norm(run.velocity(1)) > 0.1;
      }
      std::printf("  %-8s on a mesh %s: %d of 6 touched; momentum to %.1e, energy above the start %.1e\n",
                  name, ball ? "of a sphere" : "of a box", touched, worst, largest);
      EXPECT_GE(touched, 4);
      EXPECT_LT(worst, 1e-8);
      EXPECT_LT(largest, 1e-3);
    }
}

// Bodies that fall on hills, in other frames and a second time.
TEST(MeshContact, MovesTheSameInEveryFrame) {
  MeshScene s;
  s.add_ground("hills", field(8, 4, 80, 40, [](double x, double y) {
                 return 0.05 * std::sin(3 * x) * std::cos(2 * y + 1);
               }));
  const BodyId box = s.add_box("box", 1, {0.2, 0.3, 0.1}, {0, 0, 0.4});
  s.add_ball("ball", 0.5, 0.1, {2, 0, 0.3});
  s.add("rod", 0.7, {0.01, 0.01, 0.001}, {-2, 0, 0.4}, scene::CapsuleShape{0.05, 0.4, {}});
  s.body(box).twist = {{0.5, 0.2, 0}, {3, 1, -2}};
  s.body({1}).twist = {{1, 0, 0}, {0, 0, 9}};
  s.body({2}).twist = {{0, 0.5, 0}, {1, 2, 3}};
  s.material() = {"stuff", 1e5, 0, 0, 0.4, 0.3};
  const auto end = [&](const scene::Scene& scene, std::string* hash = nullptr) {
    ContactRun run(scene, 1e-3);
    run.advance(400);
    expect_energy(run, 1e-9);
    std::vector<Vec3d> positions;
    for (std::size_t b = 0; b < 3; ++b) positions.push_back(run.position(b));
    if (hash) *hash = run.facts().at("mbd_state_hash").get<std::string>();
    return positions;
  };
  std::string once, twice;
  const std::vector<Vec3d> here = end(s.scene, &once);
  end(s.scene, &twice);
  EXPECT_EQ(once, twice);
  std::mt19937_64 random(11);
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const test::RigidMotion motion(test::random_rotation(random), {0, 0, 0}, {3. * i, -2, 1});
    const std::vector<Vec3d> there = end(test::moved(s.scene, motion));
    for (std::size_t b = 0; b < 3; ++b) worst = std::max(worst, norm(motion.point_back(there[b]) - here[b]));
  }
  expect_near("largest deviation in three frames [m]", worst, 0, 1e-6);
}

// What a body costs does not depend on how many triangles are elsewhere.
TEST(MeshContact, AHundredThousandTriangles) {
  double first = 0;
  for (const int n : {0, 14, 224}) {
    MeshScene s;
    const double size = n == 0 ? 1 : 0.1 * n;
    if (n == 0)
      s.add_floor();
    else
      s.add_ground("field", field(size, size, n, n, [](double, double) { return 0.; }));
    for (int i = 0; i < 9; ++i)
      s.add_box("box" + std::to_string(i), 1, {0.1, 0.1, 0.1},
                {0.3 * (i % 3) - 0.3, 0.3 * (i / 3) - 0.3, 0.05});
    s.material() = {"stuff", 1e5, 0, 0, 0.3, 0.4};
    const std::clock_t begin = std::clock();
    ContactRun run = s.run(1e-2);
    const std::clock_t built = std::clock();
    run.advance(100);
    const double seconds = static_cast<double>(std::clock() - built) / CLOCKS_PER_SEC,
                 steps = static_cast<double>(run.facts().at("mbd_steps").get<std::uint64_t>());
    std::printf("  %6d triangles: built in %.3f s, %.1f us per step and box\n", 2 * n * n,
                static_cast<double>(built - begin) / CLOCKS_PER_SEC, 1e6 * seconds / steps / 9);
    if (n == 14) first = seconds / steps;
    if (n == 224) {
      EXPECT_LT(seconds / steps, 3 * first);
    }
  }
}

TEST(MeshContact, BadMeshesAreRefused) {
  const auto refused = [](TriangleMesh mesh) {
    MeshScene s;
    s.add_ground_mesh("mesh", std::move(mesh));
    s.add_ball("ball", 1, 0.1, {0, 0, 5});
    return refusal_of(s, 0);
  };
  TriangleMesh box = box_mesh({1, 1, 1});
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  EXPECT_NE(refused(box).find("clockwise"), std::string::npos) << refused(box);
  box = box_mesh({1, 1, 1});
  std::swap(box.triangles[3][0], box.triangles[3][1]);
  EXPECT_NE(refused(box).find("opposite winding"), std::string::npos) << refused(box);
  box = box_mesh({1, 1, 1});
  box.vertices.push_back({0, 0, 3});
  box.triangles.push_back({0, 1, 8});
  EXPECT_NE(refused(box).find("more than two triangles"), std::string::npos) << refused(box);
  // A file in millimetres, of a body that is elsewhere: the message has the coordinates of the file.
  MeshScene mm;
  mm.meshes.push_back({"b/b", box});
  for (Vec3d& p : box.vertices) p = 1e3 * p;
  mm.add("b", 1, {1, 1, 1}, {7, 8, 9}, scene::MeshShape{"file", 1e-3});
  const auto corner = [&](std::size_t i) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", box.vertices[i].x, box.vertices[i].y, box.vertices[i].z);
  };
  const std::string edge = "the edge from " + corner(0) + " to " + corner(1) + " of the file belongs to more";
  EXPECT_NE(refusal_of(mm, 0).find(edge), std::string::npos) << edge << "\n" << refusal_of(mm, 0);

  MeshScene unscaled;
  unscaled.add_ground_mesh("block", box_mesh({1000, 1000, 1000}));
  unscaled.add_ball("ball", 1, 0.1, {0, 0, 1});
  EXPECT_NE(refusal_of(unscaled, 0)
                .find("file is 1000 m wide with a scale of 1: a file in millimetres needs \"scale\": 0.001"),
            std::string::npos)
      << refusal_of(unscaled, 0);
  MeshScene inside;
  inside.add_ground_mesh("block", box_mesh({4, 4, 4}));
  inside.add_ball("ball", 1, 0.1, {0, 0, 0});
  EXPECT_NE(refusal_of(inside, 0).find("is inside"), std::string::npos) << refusal_of(inside, 0);
  // A rod that pierces a plate: its centre and its ends are outside.
  MeshScene pierced;
  pierced.add_ground_mesh("plate", box_mesh({4, 4, 0.1}));
  pierced.add("rod", 1, {1, 1, 0.1}, {0.3, 0.2, 0.4}, scene::CapsuleShape{0.03, 2, {}});
  EXPECT_NE(refusal_of(pierced, 0).find("is inside"), std::string::npos) << refusal_of(pierced, 0);
  // A box that reaches into a block with one end, and one around a mesh.
  MeshScene reaching;
  reaching.add_ground_mesh("block", box_mesh({4, 4, 4}));
  reaching.add_box("bar", 1, {6, 0.2, 0.2}, {4.5, 0.3, 0.2});
  EXPECT_NE(refusal_of(reaching, 0).find("is inside"), std::string::npos) << refusal_of(reaching, 0);
  MeshScene around;
  around.add_ground_mesh("stone", box_mesh({0.2, 0.2, 0.2}));
  around.add_box("case", 1, {4, 4, 4}, {1, 0, 0});
  EXPECT_NE(refusal_of(around, 0).find("is inside"), std::string::npos) << refusal_of(around, 0);
  MeshScene behind({0, 0, 9});
  behind.add_ground_mesh("sheet", irregular_plane(4, 8));
  behind.add_ball("ball", 1, 0.1, {0.03, 0.02, -0.5});
  EXPECT_NE(refusal_of(behind, 10).find("from behind"), std::string::npos) << refusal_of(behind, 10);
}

}  // namespace
}  // namespace tandem::mbd::contacts
