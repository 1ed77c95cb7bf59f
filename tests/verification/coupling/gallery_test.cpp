// The scenes of launch/scenes/stiff, cut short: what each scheme makes of them, with the real solvers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/verification/coupling/real_run.hpp"

namespace tandem::test {
namespace gallery_test {

using Json = nlohmann::json;

Json gallery(const std::string& name) {
  std::ifstream file(std::string(TANDEM_STIFF_SCENES) + "/" + name + ".json");
  return Json::parse(file);
}

struct GalleryCourse {
  std::string failure;  // empty: it ran to its end
  std::size_t warnings = 0;
  double residual = 0, closure = 0, outstanding = 0;  // [-]
  double iterations = 0;                              // per window
  std::vector<Pose> places;                           // of all bodies at the end
};

GalleryCourse run(Json scene, const std::string& scheme, double end_time, double shorter = 1) {
  scene["coupling"]["scheme"] = scheme;
  scene["coupling"]["window"] = scene["coupling"]["window"].get<double>() / shorter;
  scene["end_time"] = end_time;
  scene.erase("output");
  RealRun pair(scene.dump());
  GalleryCourse course;
  try {
    pair.run(end_time);
    for (const protocol::BodyState& body : pair.mbd.observe().bodies) course.places.push_back(body.pose);
  } catch (const Error& error) {
    course.failure = error.problem();
  }
  const launch::Coupler& coupler = pair.coupler();
  course.warnings = coupler.warnings().size();
  course.residual = coupler.accounts().energy_residual();
  course.closure = coupler.accounts().impulse_closure();
  course.outstanding = coupler.accounts().impulse_outstanding();
  if (coupler.accounts().windows() > 0)
    course.iterations = static_cast<double>(coupler.counters().iterations) /
                        static_cast<double>(coupler.accounts().windows());
  return course;
}

// The largest of all bodies; a turn counts at an arm of 0.1 m.
double distance(const GalleryCourse& a, const GalleryCourse& b) {
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.places.size(), b.places.size()); ++i) {
    const Pose &p = a.places[i], &q = b.places[i];
    largest =
        std::max({largest, norm(p.p_WB - q.p_WB), 0.1 * norm(rotation_vector(p.q_WB * q.q_WB.conjugate()))});
  }
  return largest;
}

void print(const std::string& scheme, const GalleryCourse& course, const GalleryCourse& reference) {
  std::printf("  | %-15s | %-7s | %8.1e m | %9.1e | %.0e | %.1e | %zu | %.1f | %s\n", scheme.c_str(),
              course.failure.empty() ? "ran" : "stopped", distance(course, reference), course.residual,
              course.closure, course.outstanding, course.warnings, course.iterations, course.failure.c_str());
}

const char* const schemes[] = {"parallel", "mbd_first", "dem_first", "linear_implicit", "implicit"};

struct Scene {
  const char* name;
  double end_time;  // of the quick test [s]
};
constexpr Scene scenes[] = {{"undamped_contact", 0.1}, {"light_plate", 0.05},    {"hydraulic_bucket", 0.1},
                            {"pressed_linkage", 0.1},  {"hammer", 0.005},        {"flywheel", 0.1},
                            {"bouncing", 0.2},         {"window_too_large", 0.1}};

void PrintTo(const Scene& scene, std::ostream* out) {
  *out << scene.name;
}

class Gallery : public testing::TestWithParam<Scene> {};
INSTANTIATE_TEST_SUITE_P(Stiff, Gallery, testing::ValuesIn(scenes),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

// Whatever becomes of a scheme: impulse closes, and what stops has a sentence.
void show(const Json& scene, double end_time) {
  const GalleryCourse reference = run(scene, "implicit", end_time, 10);
  std::printf("  reference: implicit with a tenth of the window, energy residual %.1e %s\n",
              reference.residual, reference.failure.c_str());
  for (const char* scheme : schemes) {
    const GalleryCourse course = run(scene, scheme, end_time);
    print(scheme, course, reference);
    EXPECT_LT(course.closure, 1e-12) << scheme;
    // linear_implicit gives the bodies other impulses than the particles recorded, and reports it.
    if (std::string(scheme) != "linear_implicit") {
      EXPECT_EQ(course.outstanding, 0) << scheme;
    }
  }
}

// The table of docs/coupling.md.
TEST_P(Gallery, EverySchemeInShort) {
  show(gallery(GetParam().name), GetParam().end_time);
}

// The plate against 5.4 kg of grains; implicit_test.cpp has the same where contacts do not open.
TEST(LightPlate, ImplicitHoldsItInHeavyGrains) {
  for (const double ratio : {1.0, 1e-1, 1e-2, 1e-3, 1e-4}) {
    Json scene = gallery("light_plate");
    const double mass = 5.4 * ratio, end_time = 0.06;
    scene["mbd"]["bodies"][0]["mass"] = mass;
    for (Json& moment : scene["mbd"]["bodies"][0]["inertia"]) moment = 0.01 * mass;
    std::printf("  plate of %.3g kg, mass ratio %.0e\n", mass, ratio);
    Json followed = scene;
    // A touch throws so light a plate within a window: shorter windows, down to the micro step, find a path.
    if (ratio < 1e-2) followed["coupling"]["adaptive"] = {{"min_window", 5e-5}, {"max_window", 1e-3}};
    const GalleryCourse implicit = run(followed, "implicit", end_time);
    print("implicit", implicit, {});
    EXPECT_EQ(implicit.failure, "");
    EXPECT_LT(implicit.iterations, 8);
    EXPECT_LT(std::abs(implicit.residual), 2e-4);
    EXPECT_LT(implicit.closure, 1e-12);
    EXPECT_EQ(implicit.outstanding, 0);
    for (const char* scheme : {"dem_first", "mbd_first"}) {
      const GalleryCourse held = run(scene, scheme, end_time);
      print(scheme, held, {});
      if (ratio < 1) {
        EXPECT_GT(held.warnings, 0u) << scheme;
      }
    }
  }
}

}  // namespace gallery_test
}  // namespace tandem::test
