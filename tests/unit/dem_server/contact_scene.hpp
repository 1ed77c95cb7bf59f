// One sphere on a plane, or two adjacent ones, of one material, in double precision.
#pragma once

#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/particle_run.hpp"

namespace tandem::test {

struct ContactScene {
  double young = 1e9, poisson = 0.25, density = 2500, radius = 0.01;  // [Pa] [-] [kg/m3] [m]
  nlohmann::json dem = nlohmann::json::object();        // further keys of `dem`: contact, rolling, ...
  nlohmann::json constants = nlohmann::json::object();  // of the one pair
  Vec3d gravity;                                        // [m/s2]
  int count = 1;
  bool plane = true;

  double mass() const { return 4.0 / 3 * std::numbers::pi * density * radius * radius * radius; }  // [kg]
  double moment() const { return 0.4 * mass() * radius * radius; }                                 // [kg m2]
  // For two equal spheres E* [Pa], and for the plane Hertz's k_n [N/m^1.5].
  double e_star() const { return young / (2 * (1 - poisson * poisson)); }
  double hertz() const { return 4.0 / 3 * e_star() * std::sqrt(radius); }

  std::string json() const {
    const double r = radius;
    nlohmann::json pair = {{"a", "m"}, {"b", "m"}};
    pair.update(constants);
    nlohmann::json all = {
        {"precision", "double"},
        {"materials", {{{"name", "m"}, {"density", density}, {"young", young}, {"poisson", poisson}}}},
        {"pairs", {pair}},
        {"particles",
         {{{"name", "p"},
           {"material", "m"},
           {"radius", r},
           {"fill",
            {{"type", "lattice"},
             {"min", {-2 * r, -2 * r, r}},
             {"max", {2 * r, 2 * r, 10 * r}},
             {"spacing", 2.1 * r},
             {"count", count}}}}}},
        {"domain", {{"min", {-500 * r, -500 * r, -500 * r}}, {"max", {500 * r, 500 * r, 500 * r}}}}};
    if (plane)
      all["walls"] = {{{"name", "w"},
                       {"material", "m"},
                       {"shape", {{"type", "plane"}, {"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}}};
    all.update(dem);
    return nlohmann::json{{"tandem", "1.0"},
                          {"name", "contact"},
                          {"gravity", {gravity.x, gravity.y, gravity.z}},
                          {"end_time", 1},
                          {"dem", all}}
        .dump();
  }
  // The sphere at `height` above the plane.
  ParticleRun run(double height, Vec3d velocity, Vec3d spin = {}) const {
    return ParticleRun(json(), particles::Backend::cpu, 1, [&](particles::Spheres& s) {
      s.position[0] = {0, 0, height};
      s.velocity[0] = velocity;
      s.spin[0] = spin;
    });
  }
};

// Prints and expects |measured - expected| <= tolerance |expected|.
inline void expect_close(const char* what, double measured, double expected, double tolerance) {
  std::printf("  %-52s expected %13.7g measured %13.7g error %9.2e tolerance %7.1e\n", what, expected,
              measured, std::abs(measured - expected) / std::abs(expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance * std::abs(expected)) << what;
}

}  // namespace tandem::test
