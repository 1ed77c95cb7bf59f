// A lid of a tenth and of a hundredth of the density of the water on which it lies, one spacing thick: the
// schemes with the real solvers. docs/coupling.md has the limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "coordinator/schemes/schemes.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"
#include "sph_server/coupling/load_solver.hpp"
#include "tests/doubles/coupled_run.hpp"
#include "tests/support/error_of.hpp"

#include <nlohmann/json.hpp>

namespace tandem::test {
namespace light_body_test {

constexpr double sound_speed = 9, step = 0.25 * 0.03 / sound_speed;  // of the liquid at rest [s]

nlohmann::json lid(double density, const char* scheme, double window) {
  nlohmann::json scene = nlohmann::json::parse(R"({
    "tandem": "1.1", "name": "lid", "end_time": 10, "coupling": {},
    "mbd": {"bodies": [{"name": "lid", "position": [0, 0, 0.09],
                        "shapes": [{"name": "hull", "use": "wall", "shape": {"type": "box", "size": [0.08, 0.06, 0.02]}}]}]},
    "sph": {
      "spacing": 0.02,
      "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.1,
                   "fill": [{"type": "box", "min": [-0.08, -0.06, 0], "max": [0.08, 0.06, 0.08]}]}],
      "walls": [{"name": "tank", "position": [0, 0, 0.1], "shape": {"type": "box", "size": [0.16, 0.12, 0.2], "open": ["+z"]}}],
      "domain": {"min": [-0.3, -0.3, -0.3], "max": [0.3, 0.3, 0.6]}
    }
  })");
  const double mass = density * 0.08 * 0.06 * 0.02;
  nlohmann::json& body = scene["mbd"]["bodies"][0];
  body["mass"] = mass;
  body["inertia"] = {mass / 12 * (0.06 * 0.06 + 0.02 * 0.02), mass / 12 * (0.08 * 0.08 + 0.02 * 0.02),
                     mass / 12 * (0.08 * 0.08 + 0.06 * 0.06)};
  scene["sph"]["liquids"][0]["sound_speed"] = sound_speed;
  scene["coupling"] = {{"scheme", scheme}, {"window", window}};
  return scene;
}

class LidRun {
 public:
  explicit LidRun(const nlohmann::json& scene)
      : run_(mbd_, sph_, scene::parse(scene.dump(), "lid.json"), scene.dump()) {}
  void advance() {
    run_.advance(run_.scene().coupling.window);
    fastest = std::max(fastest, norm(run_.exchange().motion.bodies.at(0).end_twist.v_WB));
  }
  launch::Coupler& coupler() { return run_.coupler(); }
  double fastest = 0;  // [m/s]

 private:
  mbd::MbdSolver mbd_;
  sph::Solver sph_;
  CoupledRun run_;
};

TEST(LightLid, IsStableWithImplicitFromOneToTwentySteps) {
  log::setup("test", "error");
  const std::vector<double> of_each[] = {{2, 6}, {1, 20}};
  for (const double density : {100.0, 10.0})
    for (const double steps : of_each[density < 50]) {
      LidRun run(lid(density, "implicit", steps * step));
      const int windows = steps > 10 ? 6 : 12;
      for (int i = 0; i < windows; ++i) run.advance();
      const launch::Coupler& coupler = run.coupler();
      const double iterations = static_cast<double>(coupler.counters().iterations) / windows;
      std::printf(
          "density %g, %g steps in a window: fastest %.3g m/s (expected below 0.1), %.2f iterations (below "
          "8)\n",
          density, steps, run.fastest, iterations);
      EXPECT_LT(run.fastest, 0.1);
      EXPECT_LT(iterations, 8);
      EXPECT_TRUE(coupler.warnings().empty()) << coupler.warnings()[0];
    }
}

TEST(LightLid, IsNamedInTheFirstWindowOfTheOtherSchemes) {
  log::setup("test", "error");
  for (const char* scheme : {"dem_first", "parallel", "mbd_first"}) {
    LidRun run(lid(100, scheme, 2 * step));
    run.advance();
    ASSERT_EQ(run.coupler().warnings().size(), 1u) << scheme;
    EXPECT_THAT(run.coupler().warnings()[0], testing::HasSubstr("body 'lid' is light for the liquid on it"));
    EXPECT_THAT(run.coupler().warnings()[0], testing::HasSubstr("use coupling.scheme = \"implicit\""));
    if (scheme != std::string("dem_first")) continue;
    const std::string end = error_of([&] {
      for (int i = 0; i < 60; ++i) run.advance();
    });
    std::printf("%s: %s\n", scheme, end.c_str());
    EXPECT_THAT(end, testing::HasSubstr("a wall of body 'lid', which is in the liquid, has"));
  }
}

TEST(LightLid, IsStableWithLinearImplicit) {
  log::setup("test", "error");
  for (const double steps : {6.0, 20.0}) {
    LidRun run(lid(100, "linear_implicit", steps * step));
    for (int i = 0; i < (steps > 10 ? 6 : 15); ++i) run.advance();
    std::printf("linear_implicit, %g steps in a window: fastest %.3g m/s (expected below 0.3)\n", steps,
                run.fastest);
    EXPECT_LT(run.fastest, 0.3);
  }
}

}  // namespace light_body_test
}  // namespace tandem::test
