#include "tests/verification/dem/impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"

namespace tandem::test {

std::vector<Variant> contact_variants() {
  return {{"hertz_mindlin", "hertz_mindlin", "", true},
          {"hertz_frictionless", "hertz_frictionless", "", false},
          {"paper", "paper", "", true},
          {"generic", "hertz_mindlin", R"("variant": "generic",)", true},
          {"generic_double", "hertz_mindlin", R"("precision": "double",)", true}};
}
std::vector<Variant> more_laws() {
  return {{"hooke", "hooke", "", true},
          {"jkr", "jkr", "", true},
          {"sjkr", "sjkr", "", true},
          {"hooke_double", "hooke", R"("precision": "double",)", true},
          {"paper_double", "paper", R"("precision": "double",)", true},
          {"jkr_double", "jkr", R"("precision": "double",)", true}};
}

double Ball::mass() const {
  return 4.0 / 3.0 * std::numbers::pi * density * radius * radius * radius;
}
double Ball::stiffness_on_plane() const {
  return 4.0 / 3.0 * young / (1 - poisson * poisson) * std::sqrt(radius);
}
double Ball::stiffness_of_pair() const {
  return 4.0 / 3.0 * young / (2 * (1 - poisson * poisson)) * std::sqrt(radius / 2);
}
double Ball::spring() const {
  return stiffness_on_plane() * std::sqrt(1e-2 * radius);
}
double Ball::deepest_on_plane(double v_n) const {
  return std::pow(1.25 * mass() * v_n * v_n / stiffness_on_plane(), 0.4);
}
double Ball::duration_on_plane(double v_n) const {
  return 2.9432 * deepest_on_plane(v_n) / v_n;
}

namespace {

nlohmann::json pair_of(const Variant& variant, const Ball& ball, const char* with, double stiffness) {
  // These constants make the normal force of the law `paper` that of Hertz with this restitution, and its
  // sliding, too, where the slip does not reverse.
  const double l = std::log(std::max(ball.restitution, 1e-300));
  const double alpha = -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  nlohmann::json pair = {{"a", "ball"},
                         {"b", with},
                         {"restitution", ball.restitution},
                         {"friction", ball.friction},
                         {"normal_stiffness", stiffness},
                         {"normal_damping", alpha * std::sqrt(ball.mass() * stiffness)},
                         {"tangential_stiffness", 0.8 * stiffness},
                         {"tangential_damping", 0.0},
                         {"spring_stiffness", ball.spring()},
                         {"work_of_adhesion", 0.0},
                         {"cohesion_energy_density", 0.0}};
  pair.update(nlohmann::json::parse("{" + std::string(variant.constants) + "}"));
  return pair;
}

}  // namespace

std::string impact_scene(const Variant& variant, const Ball& ball, int count, const std::string& walls) {
  const double r = ball.radius, side = 2.2 * r;
  const nlohmann::json dem = {
      {"contact", variant.law},
      {"materials",
       {{{"name", "ball"}, {"density", ball.density}, {"young", ball.young}, {"poisson", ball.poisson}},
        {{"name", "rigid"}, {"density", 1000}, {"young", 1e25}, {"poisson", 0.3}}}},
      {"pairs",
       {pair_of(variant, ball, "ball", ball.stiffness_of_pair()),
        pair_of(variant, ball, "rigid", ball.stiffness_on_plane())}},
      {"particles",
       {{{"name", "balls"},
         {"material", "ball"},
         {"radius", r},
         {"fill",
          {{"type", "lattice"},
           {"min", {-side / 2, -side / 2, r}},
           {"max", {side / 2, side / 2, r + count * side}},
           {"spacing", side},
           {"count", count}}}}}},
      {"walls", nlohmann::json::parse("[" + walls + "]")},
      {"domain", {{"min", {-50 * r, -50 * r, -50 * r}}, {"max", {50 * r, 50 * r, 50 * r}}}}};
  std::string text = dem.dump();
  text.insert(1, variant.options);
  return R"({"tandem": "1.0", "name": "impact", "gravity": [0, 0, 0], "end_time": 1, "dem": )" + text + "}";
}

Rebound impact_on_plane(const Variant& variant, const Ball& ball, Vec3d velocity, Vec3d spin, int steps) {
  return impact_on_walls(impact_scene(variant, ball, 1, rigid_plane), {}, ball, {}, velocity, spin, steps);
}

Rebound impact_on_walls(const std::string& scene, const std::vector<NamedMesh>& meshes, const Ball& ball,
                        Vec3d at, Vec3d velocity, Vec3d spin, int steps) {
  const auto start = [&](particles::Spheres& s) {
    s.position = {{at.x, at.y, ball.radius}};
    s.velocity = {velocity};
    s.spin = {spin};
  };
  ParticleRun run(scene, tested_backend(), 1, start, meshes);
  const double dt = ball.duration_on_plane(-velocity.z) / steps;
  constexpr std::uint32_t at_once = 100;
  Rebound result;
  particles::Spheres now;
  for (int step = 0; step < 10 * steps; step += at_once) {
    const dem::WindowOutcome& o = run.advance(at_once, dt);
    for (const Wrench& on_plane : o.load) {
      if (on_plane.force.z != 0) result.duration += dt;
      result.force = std::max(result.force, -on_plane.force.z);
    }
    result.deepest = static_cast<double>(o.window.max_overlap_ratio) * ball.radius;
    now = run.state();
    if (now.size() == 0) throw std::runtime_error("the ball left the domain");
    if (now.velocity[0].z > 0 && now.position[0].z > ball.radius) break;
  }
  result.velocity = now.velocity[0];
  result.spin = now.spin[0];
  return result;
}

void expect_row(const Variant& variant, const std::string& what, double measured, double expected,
                double tolerance) {
  std::printf("  %-4s %-18s %-44s expected %13.6g measured %13.6g error %9.2e tolerance %7.1e\n",
              tested_backend_name(), variant.name, what.c_str(), expected, measured,
              std::abs(measured - expected) / std::abs(expected), tolerance);
  EXPECT_NEAR(measured, expected, tolerance * std::abs(expected)) << variant.name << ": " << what;
}

}  // namespace tandem::test
