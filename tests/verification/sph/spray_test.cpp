// Spray: particles whose kernel is not filled. No wall lets them pass, and none pulls them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "common/geometry/mass_properties.hpp"
#include "particles/io/random.hpp"
#include "sph_server/equations/time_step.hpp"
#include "sph_server/neighbours/walls.hpp"
#include "tests/verification/sph/figure.hpp"
#include "tests/verification/sph/make_engine.hpp"

namespace tandem::test {
namespace spray_test {

using namespace sph;

constexpr double g = 9.81, pi = std::numbers::pi;

void append(TriangleMesh& to, const TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// A square plate without thickness in the plane z = 0, of the edge `size`, with a square hole in its middle.
TriangleMesh holed_plate(double size, double hole) {
  TriangleMesh m;
  for (const double edge : {0.5 * size, 0.5 * hole})
    for (const auto& [x, y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{1, 1}, std::pair{-1, 1}})
      m.vertices.push_back({edge * x, edge * y, 0});
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    m.triangles.push_back({k, next, 4 + next});
    m.triangles.push_back({k, 4 + next, 4 + k});
  }
  return m;
}

// A closed vessel, 6 spacings wide, with a floor in it that has a hole of 3 spacings: the liquid above falls
// through the hole as a jet, which bursts below.
TEST(Spray, OfAJetThroughAHoleStaysInTheVessel) {
  constexpr int wide = 6, high = 9, below = 8;
  constexpr double end = 0.6;  // [s]
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 1.0 / 15;
  l.gravity = {0, 0, -g};
  l.artificial = 0.02;
  const double a = l.spacing, width = wide * a, top = (high + 3) * a, bottom = -below * a;
  l.sound_speed = suggested_sound_speed(std::sqrt(2 * g * (high + below) * a), g, 0);
  setup.walls = {transformed(box_mesh({width, width, top - bottom}), Pose{{0, 0, 0.5 * (top + bottom)}, {}}),
                 holed_plate(width, 3 * a)};
  setup.domain = {{-width, -width, bottom - a}, {width, width, top + a}};
  const auto engine = make_engine(setup, true);
  LiquidState start;
  for (int k = 0; k < wide * wide * high; ++k) {
    start.position.push_back(
        a * Vec3d{k % wide + 0.5 - wide / 2, k / wide % wide + 0.5 - wide / 2, k / wide / wide + 0.5});
    start.velocity.push_back({});
    start.compression.push_back(0);
  }
  engine->set_state(start);
  const EnergyBalance begin = engine->energies();
  for (double t = 0; t < end;) {
    const StepFigures f = engine->figures();
    const double dt = 0.95 * step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    engine->step(dt);
  }
  double fallen = 0, outside = 0;
  for (const Vec3d& x : engine->state().position) {
    fallen += x.z < 0 ? 1 : 0;
    outside +=
        std::max({std::fabs(x.x) - width / 2, std::fabs(x.y) - width / 2, x.z - top, bottom - x.z}) > 0;
  }
  const EnergyBalance e = engine->energies();
  std::printf("jet through a hole of 3 spacings: %.0f of %zu particles fell through it in %.1f s\n", fallen,
              start.size(), end);
  EXPECT_GT(fallen, 40);
  expect_figure("particles outside the vessel", 0, outside, 0);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
  expect_figure("change of energy - works / work of gravity", 0,
                (e.kinetic + e.compression - begin.kinetic - begin.compression - e.changes()) / e.gravity,
                0.02);
}

// Four particles at the place of one, in a corner of a box of liquid at rest: they come apart.
TEST(Spray, ComesApartWhereItIsPressedTogether) {
  constexpr int wide = 6, deep = 4, more = 3;
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.1;
  l.gravity = {0, 0, -g};
  l.artificial = 0.1;
  const double a = l.spacing, width = wide * a, height = 2 * deep * a;
  l.sound_speed = suggested_sound_speed(0, g, deep * a);
  setup.walls = {transformed(box_mesh({width, width, height}), Pose{{0, 0, 0.5 * height}, {}})};
  setup.domain = {{-width, -width, -a}, {width, width, height + a}};
  const auto engine = make_engine(setup, true);
  LiquidState start;
  const auto put = [&](Vec3d x) {
    start.position.push_back(x);
    start.velocity.push_back({});
    start.compression.push_back(0);
  };
  for (int k = 0; k < wide * wide * deep; ++k)
    put(a * Vec3d{k % wide + 0.5 - wide / 2, k / wide % wide + 0.5 - wide / 2, k / wide / wide + 0.5});
  for (int k = 0; k < more; ++k)
    put(start.position[0] + 0.02 * a * Vec3d{k == 0 ? 1.0 : 0, k == 1 ? 1.0 : 0, k == 2 ? 1.0 : 0});
  engine->set_state(start);
  for (double t = 0; t < 0.5;) {
    const StepFigures f = engine->figures();
    const double dt = 0.95 * step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    engine->step(dt);
  }
  const LiquidState end = engine->state();
  double closest = width;
  for (std::size_t i = 0; i < end.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      closest = std::min(closest, norm(end.position[i] - end.position[j]) / a);
  std::printf("four particles at one place of a corner, 0.5 s later\n");
  expect_figure("distance of the nearest two [spacings]", 0.75, closest, 0.25);
  expect_figure("particles that passed a wall", 0, static_cast<double>(engine->figures().passed_walls), 0);
}

// A vessel that is star-shaped about its middle, with facets at all angles.
TriangleMesh bumpy_vessel(particles::Random& random, double radius) {
  TriangleMesh m = sphere_mesh(1, 8);
  const double uneven = random.uniform(0, 0.35);
  for (Vec3d& v : m.vertices) v = radius * (1 + random.uniform(-uneven, uneven)) * v;
  return m;
}

Vec3d direction(particles::Random& random) {
  for (;;) {
    const Vec3d d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm2(d) <= 1 && norm2(d) > 0.01) return normalized(d);
  }
}

Mat3d rotation(particles::Random& random) {
  return exp(random.uniform(0, pi) * direction(random)).matrix();
}

TriangleMesh rotated(TriangleMesh m, const Mat3d& R, Vec3d p) {
  for (Vec3d& v : m.vertices) v = p + R * v;
  return m;
}

struct Passes {
  double outside = 0, counted = 0, faster = 0, energy = 0;
};

// Particles alone and in pairs fly at up to a tenth of the speed of sound against the inside of a closed
// vessel and against sheets in it, with edges and holes, all of which move and turn as one body.
Passes spray(std::uint64_t seed) {
  particles::Random random(seed);
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.01;
  l.sound_speed = 30;
  const double a = l.spacing, radius = random.uniform(5, 7) * a, fastest = 0.1 * l.sound_speed;
  TriangleMesh vessel;
  switch (random.bits() % 3) {
    case 0:
      vessel = bumpy_vessel(random, radius);
      break;
    case 1:
      vessel = cylinder_mesh(0.7 * radius, radius, 12);
      break;
    default:
      vessel.vertices = {{-radius, -radius, -radius},
                         {radius, -radius, -radius},
                         {0, radius, -radius},
                         {0, random.uniform(-1, 1) * radius, 2 * radius}};
      vessel.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  }
  TriangleMesh walls = vessel;
  for (std::uint64_t k = random.bits() % 3; k > 0; --k) {
    const double size = random.uniform(0.5, 1.2) * radius;
    append(walls, rotated(holed_plate(size, random.uniform(0.3, 0.7) * size), rotation(random),
                          0.4 * radius * direction(random)));
  }
  const double extent = 3 * radius;
  const Vec3d w = (random.uniform(0, 0.03) * l.sound_speed / radius) * direction(random),
              v = (random.uniform(0, 0.03) * l.sound_speed) * direction(random);
  const double end = 60 * a / fastest, room = extent + end * norm(v);
  setup.walls = {walls};
  setup.domain = {{-room, -room, -room}, {room, room, room}};
  const auto pose = [&](double t) { return particles::BodyPose{t * v, exp(t * w).matrix(), v, w}; };
  const Walls clear({walls}, a);
  LiquidState start;
  while (start.size() < 40) {
    const double along_x = random.uniform(-1.4, 1.4), along_y = random.uniform(-1.4, 1.4);
    const Vec3d x = radius * Vec3d{along_x, along_y, random.uniform(-1.4, 2)};
    NearWalls near;
    clear.find(x, 0.5 * a, near);
    if (std::fabs(winding_number(vessel, x)) < 0.5 || near.count > 0 ||
        std::ranges::any_of(start.position, [&](Vec3d y) { return norm(x - y) < a; }))
      continue;
    start.position.push_back(x);
    start.velocity.push_back(v + cross(w, x) + fastest * random.uniform(0.3, 1) * direction(random));
    start.compression.push_back(0);
  }
  const auto engine = make_engine(setup, true);
  engine->set_state(start, {pose(0)});
  const EnergyBalance begin = engine->energies();
  double top = 0;
  for (double t = 0; t < end;) {
    const StepFigures f = engine->figures();
    top = std::max(top, f.largest_speed);
    const double dt = step_limits(l, f.largest_speed, f.largest_acceleration).smallest;
    t += dt;
    engine->step(dt, {pose(t)});
  }
  Passes passes;
  const particles::BodyPose last = engine->poses()[0];
  for (const Vec3d& x : engine->state().position)
    passes.outside += std::fabs(winding_number(vessel, last.R.transpose_times(x - last.p))) < 0.5 ? 1 : 0;
  passes.counted = static_cast<double>(engine->figures().passed_walls);
  passes.faster = top / fastest;
  const EnergyBalance e = engine->energies();
  passes.energy =
      (e.kinetic + e.compression - begin.kinetic - begin.compression - e.changes()) / begin.kinetic;
  return passes;
}

// A particle alone at a tenth of the speed of sound, in front of the edge x = 0 of a sheet that is in the
// plane z = 0, and beside it by `offset` [spacings]. Returns the force of the sheet on it, positive where it
// pushes back, at its most and its least [N], and the velocity at the end.
struct AtEdge {
  double most = 0, least = 0;
  Vec3d x, v;
  double passed = 0;
};
AtEdge fly_at_edge(double offset, Vec3d velocity, double compression) {
  LiquidSetup setup;
  Liquid& l = setup.liquid;
  l.spacing = 0.01;
  l.sound_speed = 30;
  const double a = l.spacing;
  TriangleMesh sheet;
  sheet.vertices = {{0, -1, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, -1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  setup.walls = {sheet};
  setup.domain = {{-1, -1, -1}, {1, 1, 1}};
  const auto engine = make_engine(setup, true);
  LiquidState start;
  start.position = {{2 * a, 0, offset * a}};
  if (velocity.x == 0) start.position[0] = {-4 * a, 0, offset * a};
  start.velocity = {velocity};
  start.compression = {compression};
  engine->set_state(start);
  AtEdge found;
  // Until it is 2.2 spacings from the sheet.
  for (int k = 0; k < 100; ++k) {
    const StepFigures f = engine->figures();
    engine->step(step_limits(l, f.largest_speed, f.largest_acceleration).smallest);
    const Vec3d push = -engine->loads()[0].force;
    found.most = std::max({found.most, push.x, push.z});
    found.least = std::min(found.least, push.z);
  }
  found.x = engine->state().position[0];
  found.v = engine->state().velocity[0];
  found.passed = static_cast<double>(engine->figures().passed_walls);
  return found;
}

TEST(Spray, IsStoppedByTheEdgeOfASheet) {
  std::printf(
      "a particle flies along the plane of a sheet against its edge, at a tenth of the speed of sound\n");
  double passed = 0;
  for (const double offset : {0.0, 1e-9, 0.02, 0.2, 0.6})
    for (const double up : {0.0, -0.01, -0.3}) {
      const AtEdge one = fly_at_edge(offset, Vec3d{-3, 0, 3 * up}, 0);
      passed += one.passed + (one.x.x < 0 && one.x.z < 0 && up == 0 ? 1 : 0);
      if (offset == 0 && up == 0) expect_figure("speed after / before, in the plane", 1, one.v.x / 3, 0.1);
    }
  expect_figure("particles that passed the sheet", 0, passed, 0);
}

// A particle that has expanded in a liquid, and is alone beside a wall that it leaves, or at rest there.
TEST(Spray, IsNotPulledByAWall) {
  std::printf("a particle alone, expanded by 5 %%, half a spacing from a sheet\n");
  for (const double speed : {0.0, 1.0}) {
    const AtEdge one = fly_at_edge(0.5, {0, 0, speed}, -0.05);
    expect_figure("least force of the sheet [N]", 0, one.least, 0);
    expect_figure("velocity gained across the sheet [m/s]", 0, one.v.z - speed, 0.01);
  }
}

TEST(Spray, PassesNoWallOfRandomVesselsThatMove) {
  constexpr int vessels = SOAK ? 12 : 3;
  std::printf("%d vessels with sheets, 40 particles each, at up to a tenth of the speed of sound\n", vessels);
  Passes all;
  for (int k = 0; k < vessels; ++k) {
    const Passes one = spray(static_cast<std::uint64_t>(k) + 1);
    if (one.outside + one.counted > 0)
      std::printf("  vessel %d: %.0f outside, %.0f passes\n", k, one.outside, one.counted);
    all.outside += one.outside;
    all.counted += one.counted;
    all.faster = std::max(all.faster, one.faster);
    all.energy = std::max(all.energy, std::fabs(one.energy));
  }
  std::printf("  largest speed %.2f of a tenth of the speed of sound\n", all.faster);
  expect_figure("particles outside their vessel", 0, all.outside, 0);
  expect_figure("particles that passed a wall", 0, all.counted, 0);
  expect_figure("change of energy - works / start", 0, all.energy, 0.05);
}

}  // namespace spray_test
}  // namespace tandem::test
