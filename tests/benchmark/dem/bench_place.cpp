// Wall and CPU time of placing spheres in a container of triangles, without reading files or starting
// solvers.
//
// usage: bench_place SPHERES [THREADS] [VOID_FRACTION]
// The container is a closed mesh: a ring of 3,200 triangles. Radii are between 1 and 1.3 of the smallest.
// Prints one row: spheres,triangles,threads,void_fraction,sweeps,wall_s,cpu_s,void_fraction_reached,host
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "common/cpu_time.hpp"
#include "common/error.hpp"
#include "common/geometry/mass_properties.hpp"
#include "particles/io/place.hpp"
#include "tests/support/torus.hpp"

namespace tandem {
namespace {

void measure(double spheres, unsigned threads, double void_fraction) {
  const TriangleMesh ring = tandem::test::torus(0.5, 0.2, 80, 20);
  const double volume = mass_of_mesh(ring, 1).mass,
               smallest =
                   std::cbrt((1 - void_fraction) * volume / spheres / 1.54678 * 3 / 4 / std::numbers::pi);
  scene::Scene scene;
  scene.dem.emplace();
  scene.dem->domain = {{-1, -1, -1}, {1, 1, 1}};
  scene.dem->materials.push_back({"steel", 7800, 2e11, 0.3});
  scene::Wall wall;
  wall.name = "ring";
  wall.shape = scene::MeshShape{"ring.stl"};
  scene.dem->walls.push_back(wall);
  scene::ParticleGroup group;
  group.name = "grains";
  group.radius_min = smallest;
  group.radius_max = 1.3 * smallest;
  scene::PackingFill fill;
  fill.region = scene::InsideWall{"ring"};
  fill.void_fraction = void_fraction;
  group.fill = fill;
  scene.dem->particles.push_back(group);
  const double cpu_begin = cpu_seconds(CpuClock::process);
  const auto begin = std::chrono::steady_clock::now();
  const particles::Placement placed = particles::place(scene, 0, {{"ring", ring}}, {}, {}, threads);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  fmt::print("{},{},{},{},{},{:.2f},{:.2f},{:.5f},{}\n", placed.radius.size(), ring.triangles.size(), threads,
             void_fraction, placed.sweeps, wall_s, cpu_seconds(CpuClock::process) - cpu_begin,
             placed.void_fraction, host);
}

}  // namespace
}  // namespace tandem

int main(int count, char** arguments) {
  if (count < 2) {
    fmt::print(stderr, "usage: bench_place SPHERES [THREADS] [VOID_FRACTION]\n");
    return 2;
  }
  try {
    tandem::measure(std::atof(arguments[1]), count > 2 ? static_cast<unsigned>(std::atoi(arguments[2])) : 2,
                    count > 3 ? std::atof(arguments[3]) : 0.5);
  } catch (const tandem::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return tandem::exit_status(error.code());
  }
}
