// Frames of spheres that no participant can have come to, with the account that it gives.
#include "coordinator/watch/sphere_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>

#include "common/scene/parse.hpp"

namespace tandem::launch {
namespace {

using protocol::ParticlesFrame;
using ::testing::HasSubstr;
using Kind = SphereWatch::Kind;

constexpr double window_s = 0.01;

// Two spheres of 1 cm at (-0.1, 0, 0) and (0.1, 0, 0) above a floor.
SceneFile resting_pair(const std::string& groups = "", const std::string& of_dem = "") {
  SceneFile file;
  file.text = R"({
    "tandem": "1.1", "name": "pair", "end_time": 1, "gravity": [0, 0, -10], "coupling": {"window": 0.01},
    "dem": {
      "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0.3}],
      "particles": [{"name": "pair", "material": "glass", "radius": 0.01,
                     "fill": {"type": "lattice", "min": [-0.11, -0.01, -0.01], "max": [0.111, 0.011, 0.011], "spacing": 0.2}})" +
              groups + R"(],
      "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, -0.01], "normal": [0, 0, 1]}}],
      )" + of_dem +
              R"("domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}}
  })";
  file.scene = scene::parse(file.text, "pair.json");
  return file;
}

struct Watched {
  explicit Watched(const SceneFile& scene_file)
      : file(std::make_unique<SceneFile>(scene_file)),
        spheres(std::make_unique<SceneSpheres>(spheres_of(*file))),
        watch(file->scene, *spheres) {}
  // Windows of spheres that do not move, and that load the floor.
  void rest(int windows, double overlap = 0) {
    for (int i = 0; i < windows; ++i) {
      Exchange exchange;
      exchange.load.window = {index, Nanoseconds{static_cast<std::int64_t>(index) * 10'000'000},
                              Nanoseconds{static_cast<std::int64_t>(index + 1) * 10'000'000}};
      ++index;
      exchange.load.account.max_overlap_ratio = overlap;
      exchange.load.account.micro_step = 1e-5;
      exchange.load.account.gravity_impulse = {0, 0, -0.1 * window_s};
      exchange.load.bodies.resize(1);
      exchange.load.bodies[0].body = ground.value;
      exchange.load.bodies[0].mean.force.z = -1;
      watch.record(exchange);
    }
  }
  void see(const std::vector<Vec3d>& at, const std::vector<std::uint32_t>& ids = {0, 1}) {
    ParticlesFrame frame;
    frame.time = Nanoseconds{static_cast<std::int64_t>(index) * 10'000'000};
    frame.id = ids;
    for (const Vec3d x : at) {
      frame.position.insert(frame.position.end(), {x.x, x.y, x.z});
      frame.velocity.insert(frame.velocity.end(), {0, 0, 0});
      frame.spin.insert(frame.spin.end(), {0, 0, 0});
      frame.radius.push_back(frame.radius.empty() ? first_radius : 0.01F);
    }
    watch.observe(frame);
  }
  FalseSpheres of(Kind kind) const { return watch.false_spheres()[static_cast<std::size_t>(kind)]; }
  // All kinds but one are silent.
  void expect_only(Kind kind, std::uint64_t count, const char* sentence) const {
    for (std::size_t i = 0; i < SphereWatch::kinds.size(); ++i) {
      if (static_cast<Kind>(i) == kind) continue;
      EXPECT_EQ(watch.false_spheres()[i].spheres, 0u) << watch.false_spheres()[i].example;
    }
    EXPECT_EQ(of(kind).spheres, count);
    EXPECT_THAT(of(kind).example, HasSubstr(sentence));
  }

  std::unique_ptr<SceneFile> file;
  std::unique_ptr<SceneSpheres> spheres;
  SphereWatch watch;
  std::uint64_t index = 0;
  float first_radius = 0.01F;
};

const std::vector<Vec3d> at_start{{-0.1, 0, 0}, {0.1, 0, 0}};

TEST(SphereWatch, SpheresAtRestAreSilent) {
  Watched w(resting_pair());
  w.see(at_start);
  w.rest(5);
  w.see(at_start);
  w.expect_only(Kind::path, 0, "");
}

TEST(SphereWatch, ExchangedIdsGoFartherThanTheirEnergyTakesThem) {
  Watched w(resting_pair());
  w.see(at_start);
  w.rest(5);
  w.see({{0.1, 0, 0}, {-0.1, 0, 0}});
  w.expect_only(Kind::path, 2,
                "its spheres have moved by 0.2 m, and by at most 0.001 m with the kinetic energy");
}

TEST(SphereWatch, ARadiusIsForEver) {
  Watched w(resting_pair());
  w.see(at_start);
  w.rest(5);
  w.first_radius = 0.0101F;
  w.see(at_start);
  w.expect_only(Kind::changed_radius, 1, "its sphere 0 has the radius 0.0101 m, and had 0.01 m before");
}

TEST(SphereWatch, OverlapsAreThoseOfTheAccount) {
  const std::vector<Vec3d> deep{{-0.1, 0, 0}, {-0.09, 0, 0}};
  Watched w(resting_pair());
  w.rest(5, 0.01);
  w.see(deep);
  w.expect_only(Kind::overlap, 2,
                "its spheres 0 and 1 overlap by 1 of the smaller radius, and by at most 0.01 in the account");
  Watched told(resting_pair());
  told.rest(5, 0.5);
  told.see(deep);
  EXPECT_EQ(told.of(Kind::overlap).spheres, 0u) << "the rule `overlap` judges what the account says";
}

TEST(SphereWatch, PlanesAreSolid) {
  Watched w(resting_pair());
  w.rest(5, 0.01);
  w.see({{-0.1, 0, -0.03}, {0.1, 0, 0}});
  w.expect_only(Kind::plane, 1, "its sphere 0 is 3 of its radius inside the plane 'floor'");
}

// 10 spheres, one every 20 ms.
const char* const an_inlet = R"(, {"name": "in", "material": "glass", "radius": 0.01,
  "fill": {"type": "inlet", "min": [0.3, 0.3, 0.3], "max": [0.5, 0.5, 0.5], "rate": 50, "count": 10}})";
const char* const an_outlet =
    R"("outlets": [{"name": "out", "region": {"type": "plane", "point": [0, 0, -0.5], "normal": [0, 0, -1]}}], )";

TEST(SphereWatch, InletsBringSpheresWhenTheyAreDue) {
  Watched idle(resting_pair(an_inlet));
  idle.rest(20);
  idle.see(at_start);
  idle.expect_only(Kind::inlet, 6,
                   "6 spheres of inlet 'in' are due, 0 have come in, and no sphere is in its box");
  Watched full(resting_pair(an_inlet));
  full.rest(20);
  full.see({{0.4, 0.4, 0.4}, {0.1, 0, 0}});
  EXPECT_EQ(full.of(Kind::inlet).spheres, 0u) << "spheres wait while the box is full";
  Watched early(resting_pair(an_inlet));
  early.rest(2);
  early.see({{-0.1, 0, 0}, {0.4, 0.4, 0.4}}, {0, 6});
  early.expect_only(Kind::inlet, 3, "its sphere 6 of inlet 'in' is not due before t = 0.08 s");
}

TEST(SphereWatch, OutletsTakeSpheresOut) {
  SceneFile file = resting_pair("", an_outlet);
  file.scene.dem->walls.clear();
  Watched w(file);
  w.rest(5);
  w.see({{-0.1, 0, -0.6}, {0.1, 0, -0.499}});
  w.expect_only(Kind::outlet, 1, "its sphere 0 is at (-0.1, 0, -0.6) m, inside the outlet 'out'");
}

// Of a large frame a part is searched, another one each time.
TEST(SphereWatch, OverlapsOfALargeFrameAreFound) {
  constexpr int side = 60;
  std::vector<Vec3d> at;
  std::vector<std::uint32_t> ids;
  for (int i = 0; i < side * side * side; ++i) {
    at.push_back({0.015 * (i % side) - 0.45, 0.015 * (i / side % side) - 0.45, 0.015 * (i / side / side)});
    ids.push_back(static_cast<std::uint32_t>(i));
  }
  Watched w(resting_pair());
  w.rest(5, 0.01);
  w.see(at, ids);
  EXPECT_GT(w.of(Kind::overlap).spheres, 20'000u);
  EXPECT_THAT(w.of(Kind::overlap).example, HasSubstr("overlap by 0.5 of the smaller radius"));
}

}  // namespace
}  // namespace tandem::launch
