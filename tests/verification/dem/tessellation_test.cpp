// A flat wall of any triangles must act like the analytic plane: speed and spin after an impact agree within
// 1e-3, on faces, edges and vertices, at angles up to 85 degrees from the normal, with friction.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/particle_run.hpp"
#include "tests/support/tested_backend.hpp"
#include "tests/verification/dem/impact.hpp"

namespace tandem::test {
namespace tessellation_test {

constexpr double R = 0.01;  // [m]

// Square cells of side `edge` over a square of side 2 `half` about the origin. Each cell is two triangles;
// their winding alternates.
TriangleMesh grid(double half, double edge) {
  TriangleMesh mesh;
  const auto cells = static_cast<std::uint32_t>(std::lround(2 * half / edge));
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) mesh.vertices.push_back({i * edge - half, j * edge - half, 0});
  for (std::uint32_t j = 0; j < cells; ++j)
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      if ((i + j) % 2 == 0)
        mesh.triangles.push_back({a, d, c});
      else
        mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

// Sliver triangles about the origin.
TriangleMesh fan(double radius, std::uint32_t count) {
  TriangleMesh mesh;
  mesh.vertices.push_back({});
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    mesh.triangles.push_back({0, i + 1, (i + 1) % count + 1});
  }
  return mesh;
}

struct Tessellation {
  const char* name;
  TriangleMesh mesh;
  Vec3d face, edge, vertex;  // [m]
  double skin;               // [m]; small where a larger one would make too many triangles near
};

Tessellation of_grid(const char* name, double half, double edge, double skin) {
  return {name, grid(half, edge), {0.6 * edge, 0.3 * edge, 0}, {0.5 * edge, 0, 0}, {0, 0, 0}, skin};
}

std::vector<Tessellation> tessellations() {
  return {
      {"two triangles",
       grid(10 * R, 20 * R),
       {2 * R, -3 * R, 0},
       {R, R, 0},
       {-9.999 * R, -9.999 * R, 0},
       R / 4},
      {"triangles of 1000 radii", grid(1000 * R, 1000 * R), {30 * R, 15 * R, 0}, {20 * R, 0, 0}, {}, R / 4},
      of_grid("triangles of a radius", 10 * R, R, R / 4),
      of_grid("triangles of 1/30 radius", R, R / 30, R / 20),
      of_grid("triangles of 1/1000 radius", 0.05 * R, 0.001 * R, 0.004 * R),
      {"fan of 720 slivers", fan(10 * R, 720), {3 * R, 0.013 * R, 0}, {2 * R, 0, 0}, {0, 0, 0}, R / 4}};
}

class FlatWall : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, FlatWall, testing::ValuesIn(contact_variants()),
                         [](const auto& v) { return std::string(v.param.name); });
// The adhesion is weak enough that every sphere detaches.
constexpr Variant more[] = {
    {"hooke", "hooke", "", true},
    {"jkr", "jkr", "", true, R"("work_of_adhesion": 1)"},
    {"sjkr", "sjkr", "", true, R"("cohesion_energy_density": 1e6)"},
    {"turning", "hertz_mindlin", R"("rolling": "elastic_plastic", "twisting": "elastic_plastic",)", true,
     R"("rolling_friction": 0.05, "rolling_damping": 0.3)"},
    {"jkr_turning_double", "jkr",
     R"("precision": "double", "rolling": "elastic_plastic", "twisting": "elastic_plastic",)", true,
     R"("work_of_adhesion": 1, "rolling_friction": 0.05, "rolling_damping": 0.3)"}};
INSTANTIATE_TEST_SUITE_P(MoreLaws, FlatWall, testing::ValuesIn(more),
                         [](const auto& v) { return std::string(v.param.name); });

TEST_P(FlatWall, IsThePlaneInWhateverTriangles) {
  const Ball ball{1e9, 0.3, 2500, 0.7, 0.3, R};
  const char* const mesh_wall =
      R"({"name": "mesh", "material": "rigid", "shape": {"type": "mesh", "file": "m.stl"}})";
  // An overlap of a thousandth of the radius at normal incidence.
  const double speed = std::sqrt(0.8 * ball.stiffness_on_plane() * std::pow(1e-3 * R, 2.5) / ball.mass());
  for (const Tessellation& t : tessellations()) {
    Variant variant = GetParam();
    const std::string options = variant.options + ("\"skin\": " + std::to_string(t.skin) + ",");
    variant.options = options.c_str();
    const std::string on_mesh = impact_scene(variant, ball, 1, mesh_wall),
                      on_plane = impact_scene(variant, ball, 1, rigid_plane);
    double worst_speed = 0, worst_spin = 0;
    for (const Vec3d at : {t.face, t.edge, t.vertex})
      for (const double degrees : {0.0, 5.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0}) {
        // To save time: the search for contacts among thousands of triangles is slow.
        if (t.mesh.triangles.size() > 10000 && degrees != 45 && degrees != 85) continue;
        const double angle = degrees * std::numbers::pi / 180, heading = 0.4;
        const Vec3d v{speed * std::sin(angle) * std::cos(heading),
                      speed * std::sin(angle) * std::sin(heading), -speed * std::cos(angle)};
        const Vec3d spin{20, -10, 5};
        const Rebound mesh = impact_on_walls(on_mesh, {{"mesh", t.mesh}}, ball, at, v, spin, 200);
        const Rebound plane = impact_on_walls(on_plane, {}, ball, at, v, spin, 200);
        EXPECT_GT(plane.velocity.z, 0);
        worst_speed = std::max(worst_speed, norm(mesh.velocity - plane.velocity) / norm(plane.velocity));
        if (variant.friction)
          worst_spin = std::max(worst_spin, norm(mesh.spin - plane.spin) / norm(plane.spin));
      }
    std::printf("  %-4s %-18s %-28s %7zu triangles: velocity differs by %.2e, spin by %.2e, tolerance 1e-3\n",
                tested_backend_name(), variant.name, t.name, t.mesh.triangles.size(), worst_speed,
                worst_spin);
    EXPECT_LT(worst_speed, 1e-3) << t.name;
    EXPECT_LT(worst_spin, 1e-3) << t.name;
  }
}

// Gap between ball and wall at the start; without it rounding decides whether the first step has a contact
// [m].
constexpr double start_gap = 1e-8;

// An impact on a wall of a body with this pose at the start and this constant twist. All velocities are
// relative to the body.
Rebound impact_on_body(const std::string& flat_scene, const std::vector<NamedMesh>& meshes, const Ball& ball,
                       Vec3d at, Vec3d v, Vec3d spin, Pose start, Twist body) {
  nlohmann::json scene = nlohmann::json::parse(flat_scene);
  scene["mbd"]["bodies"] = {{{"name", "tool"}, {"mass", 1}, {"inertia", {1, 1, 1}}}};
  scene["dem"]["walls"][0]["body"] = "tool";
  ParticleRun run(
      scene.dump(), tested_backend(), 1,
      [&](particles::Spheres& s) {
        const Vec3d arm = start.q_WB.rotate({at.x, at.y, ball.radius + start_gap});
        s.position = {start.p_WB + arm};
        s.velocity = {start.q_WB.rotate(v) + body.v_WB + cross(body.w_WB, arm)};
        s.spin = {start.q_WB.rotate(spin) + body.w_WB};
      },
      meshes);
  constexpr std::uint32_t steps = 100;
  const double window = steps * ball.duration_on_plane(-v.z) / 200;
  const auto pose = [&](int w) {
    return Pose{start.p_WB + (w * window) * body.v_WB, exp((w * window) * body.w_WB) * start.q_WB};
  };
  constexpr int windows = 4;  // twice the duration of an impact
  for (int w = 0; w < windows; ++w) {
    std::vector<particles::PreparedPath> paths;
    for (const BodyId id : run.surface.boundary_bodies)
      paths.push_back(id == ground ? particles::prepare_path({}, window)
                                   : particles::prepare_path({pose(w), pose(w + 1), body, body}, window));
    run.engine->advance({steps, window / steps, paths, 0, 0});
  }
  const particles::Spheres s = run.state();
  const Pose end = pose(windows);
  const auto seen = [&](Vec3d x) { return end.q_WB.conjugate().rotate(x); };
  return {seen(s.velocity[0] - body.v_WB - cross(body.w_WB, s.position[0] - end.p_WB)),
          seen(s.spin[0] - body.w_WB)};
}

TEST_P(FlatWall, IsThePlaneOnABodyThatMoves) {
  const Ball ball{1e9, 0.3, 2500, 0.7, 0.3, R};
  Variant variant = GetParam();
  const std::string options = variant.options + std::string(R"("skin": 0.0025,)");
  variant.options = options.c_str();
  const Tessellation t = of_grid("triangles of a radius", 10 * R, R, R / 4);
  const std::string
      on_mesh = impact_scene(
          variant, ball, 1,
          R"({"name": "mesh", "material": "rigid", "shape": {"type": "mesh", "file": "m.stl"}})"),
      on_plane = impact_scene(variant, ball, 1, rigid_plane);
  const Pose oblique{{0.2, -0.1, 0.15}, exp({0.4, -0.7, 1.1})};
  const Twist flying{{3, -2, 1}, {}}, turning{{3, -2, 1}, {30, -20, 40}};
  const Vec3d v{0.05, 0.03, -0.05}, spin{20, -10, 5};
  const auto differ = [&](const char* how, const Rebound& mesh, const Rebound& plane) {
    const double velocity = norm(mesh.velocity - plane.velocity) / norm(plane.velocity),
                 spins = norm(mesh.spin - plane.spin) / norm(plane.spin);
    std::printf("  %-4s %-18s %-40s velocity differs by %.2e, spin by %.2e, tolerance 1e-5\n",
                tested_backend_name(), variant.name, how, velocity, variant.friction ? spins : 0);
    EXPECT_GT(mesh.velocity.z, 0);
    EXPECT_LT(velocity, 1e-5) << how;
    if (variant.friction) {
      EXPECT_LT(spins, 1e-5) << how;
    }
  };
  for (const Vec3d at : {t.face, t.edge, t.vertex}) {
    const auto mesh_on = [&](const Twist& body) {
      return impact_on_body(on_mesh, {{"mesh", t.mesh}}, ball, at, v, spin, oblique, body);
    };
    const auto plane_on = [&](const Pose& start, const Twist& body) {
      return impact_on_body(on_plane, {}, ball, at, v, spin, start, body);
    };
    differ("flies: as the plane at rest", mesh_on(flying), plane_on({}, {}));
    differ("flies and turns: as the plane that does", mesh_on(turning), plane_on(oblique, turning));
  }
}

}  // namespace tessellation_test
}  // namespace tandem::test
