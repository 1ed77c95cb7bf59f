// Spheres that are placed in a mesh container and settle: what was asked for against what is there, measured
// from the particle files that the solvers receive and from the triangles.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/geometry/mass_properties.hpp"
#include "common/scene/particle_file.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "dem_server/coupling/make_solver.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double density = 2500, gravity = 9.81;  // [kg/m3] [m/s2]

double sphere_mass(double radius) {
  return density * 4 / 3 * std::numbers::pi * radius * radius * radius;
}

void print_head(const char* title) {
  std::printf("%s\n  %-46s %14s %14s %12s\n", title, "", "asked", "measured", "tolerance");
}
void print(const char* name, double asked, double measured, double tolerance) {
  std::printf("  %-46s %14.7g %14.7g %12.2e\n", name, asked, measured, tolerance);
}
void expect(const char* name, double asked, double measured, double tolerance) {
  print(name, asked, measured, tolerance);
  EXPECT_NEAR(measured, asked, tolerance) << name;
}
void expect_at_most(const char* name, double limit, double measured) {
  std::printf("  %-46s %14s %14.7g %12.2e\n", name, "at most", measured, limit);
  EXPECT_LE(measured, limit) << name;
}

// A six-sided hopper, closed at the top: prism above a frustum.
TriangleMesh hopper() {
  TriangleMesh mesh;
  const std::array<std::array<double, 2>, 3> rings{{{0.04, -0.15}, {0.12, 0.0}, {0.12, 0.25}}};
  for (const auto& [radius, z] : rings)
    for (int k = 0; k < 6; ++k) {
      const double angle = k * std::numbers::pi / 3;
      mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  const auto at = [](std::uint32_t ring, std::uint32_t k) { return 6 * ring + k % 6; };
  for (std::uint32_t k = 0; k < 6; ++k)
    for (std::uint32_t ring = 0; ring < 2; ++ring) {
      mesh.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    }
  for (std::uint32_t k = 1; k + 1 < 6; ++k) {
    mesh.triangles.push_back({at(0, 0), at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({at(2, 0), at(2, k), at(2, k + 1)});
  }
  return mesh;
}

// The deepest overlap of a sphere with a face of the convex hopper, relative to its radius.
double deepest(const scene::ParticleFile& spheres, const TriangleMesh& mesh) {
  double worst = -1;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]],
                n = normalized(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    for (std::size_t i = 0; i < spheres.radii.size(); ++i)
      worst = std::max(worst, 1 + dot(n, spheres.positions[i] - a) / spheres.radii[i]);
  }
  return worst;
}

double mass_of(const std::vector<double>& radii) {
  double mass = 0;
  for (const double r : radii) mass += sphere_mass(r);
  return mass;
}

double mean_energy(const scene::ParticleFile& spheres) {
  double energy = 0;
  for (std::size_t i = 0; i < spheres.radii.size(); ++i) {
    const double r = spheres.radii[i], m = sphere_mass(r);
    energy += 0.5 * m * (norm2(spheres.velocities[i]) + 0.4 * r * r * norm2(spheres.spins[i]));
  }
  return energy / static_cast<double>(spheres.radii.size());
}

class Filling : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("tandem_filling_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    setenv("TANDEM_CACHE", (folder_ / "cache").c_str(), 1);
    std::ofstream mesh(folder_ / "hopper.obj");
    mesh.precision(17);
    for (const Vec3d& v : hopper().vertices) mesh << "v " << v.x << " " << v.y << " " << v.z << "\n";
    for (const auto& t : hopper().triangles)
      mesh << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  void TearDown() override {
    unsetenv("TANDEM_CACHE");
    fs::remove_all(folder_);
  }

  json scene(const json& group, const json& fill) const {
    json scene = json::parse(R"({"tandem": "1.1", "name": "hopper", "end_time": 1,
      "dem": {"materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25,
                             "restitution": 0.4, "friction": 0.4}],
        "walls": [{"name": "hopper", "material": "glass", "shape": {"type": "mesh", "file": "hopper.obj"}}],
        "domain": {"min": [-0.2, -0.2, -0.2], "max": [0.2, 0.2, 0.3]}}})");
    json grains = {{"name", "grains"}, {"material", "glass"}, {"fill", fill}};
    grains.update(group);
    grains["fill"].update({{"type", "packing"}, {"region", {{"type", "inside"}, {"wall", "hopper"}}}});
    scene["dem"]["particles"] = {grains};
    return scene;
  }
  SceneFile read(const json& scene) const {
    std::ofstream(folder_ / "scene.json") << scene.dump();
    return read_scene(folder_ / "scene.json");
  }
  static scene::ParticleFile spheres_in(const SceneFile& file) {
    return scene::read_particle_file(file.files.at(0).text, "grains");
  }

  fs::path folder_;
};

TEST_F(Filling, VoidFractionUpToALevelAndMassAreAsAskedFor) {
  const double volume = mass_of_mesh(hopper(), 1).mass;
  print_head("Packing of a mesh container");
  const SceneFile full = read(scene({{"radius", 0.006}}, {{"void_fraction", 0.5}}));
  scene::ParticleFile spheres = spheres_in(full);
  expect("void fraction, full", 0.5, 1 - mass_of(spheres.radii) / density / volume, 0.005);
  expect_at_most("overlap with the wall / radius", 1e-5, deepest(spheres, hopper()));

  const double prism = 0.25 * 1.5 * std::numbers::sqrt3 * 0.12 * 0.12, part = volume - 0.6 * prism;
  const SceneFile level = read(scene({{"radius", 0.006}}, {{"void_fraction", 0.52}, {"level", 0.1}}));
  spheres = spheres_in(level);
  expect("void fraction up to a level", 0.52, 1 - mass_of(spheres.radii) / density / part, 0.0052);
  double top = -1;
  for (std::size_t i = 0; i < spheres.radii.size(); ++i)
    top = std::max(top, spheres.positions[i].z + spheres.radii[i]);
  expect_at_most("highest point - level [m]", 1e-9, top - 0.1);

  const SceneFile mass = read(scene({{"radius", json::array({0.004, 0.007})}}, {{"mass", 6}}));
  spheres = spheres_in(mass);
  expect("mass [kg]", 6, mass_of(spheres.radii), 0.5 * sphere_mass(0.007));
  expect_at_most("overlap with the wall / radius", 1e-5, deepest(spheres, hopper()));
}

TEST_F(Filling, SieveCurveIsMetWithinTheRoundingOfNumbers) {
  const std::vector<double> size{0.004, 0.006, 0.01, 0.016}, passing{0, 0.15, 0.6, 1};
  const SceneFile file =
      read(scene({{"sizes", {{"type", "sieve"}, {"size", size}, {"passing", passing}}}}, {{"mass", 5}}));
  const scene::ParticleFile spheres = spheres_in(file);
  print_head("Sieve curve: mass that passes");
  const double all = mass_of(spheres.radii);
  for (std::size_t k = 0; k < size.size(); ++k) {
    std::vector<double> through;
    for (const double r : spheres.radii)
      if (2 * r <= size[k] * (1 + 1e-12)) through.push_back(r);
    // One sphere of that size, and the quantiles of the class.
    expect(("sieve of " + std::to_string(1000 * size[k]) + " mm").c_str(), passing[k], mass_of(through) / all,
           sphere_mass(size[k] / 2) / all + 2e-4);
  }
  expect("mass [kg]", 5, all, 0.5 * sphere_mass(0.008));
}

TEST_F(Filling, BedSettlesToItsEnergyStaysThereAndIsTakenFromTheCache) {
  const double fall = sphere_mass(0.005) * gravity * 0.005, bound = 1e-3 * fall;
  json settling = scene({{"radius", json::array({0.005, 0.007})}}, {{"mass", 4}});
  settling["dem"]["settle"] = {{"kinetic_energy", bound}};
  const SceneFile file = read(settling);
  const scene::ParticleFile spheres = spheres_in(file);
  print_head("Settled bed");
  expect("mass [kg]", 4, mass_of(spheres.radii), 0.5 * sphere_mass(0.007));
  expect_at_most("mean kinetic energy [J]", bound, mean_energy(spheres));
  expect("the same, as reported [J]", mean_energy(spheres), file.settled->kinetic_energy, 1e-4 * bound);
  expect_at_most("overlap with the wall / radius", 0.05, deepest(spheres, hopper()));
  std::printf("  %zu spheres settled in %.3g s\n", spheres.radii.size(), file.settled->time);

  // The run starts without the springs of the contacts, which moves the bed a little.
  const std::unique_ptr<protocol::LoadSolver> solver = dem::make_solver();
  solver->configure({file.text, file.origin, file.meshes, file.files, "cpu", 0});
  protocol::MotionSet motion;
  double largest = 0;
  for (std::uint64_t window = 0; window < 100; ++window) {
    motion.window = {window, Nanoseconds{static_cast<std::int64_t>(window) * 1000000},
                     Nanoseconds{static_cast<std::int64_t>(window + 1) * 1000000}};
    largest = std::max(largest, solver->advance(motion).account.kinetic_energy);
  }
  expect_at_most("largest mean in 0.1 s of the run [J]", 2 * bound,
                 largest / static_cast<double>(spheres.radii.size()));

  const SceneFile again = read(settling);
  EXPECT_TRUE(again.settled->from_cache);
  EXPECT_EQ(again.files.at(0).text, file.files.at(0).text);
}

}  // namespace
}  // namespace tandem::launch
