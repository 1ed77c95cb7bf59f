// The spheres at the start of a run, and what must hold before it may begin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "common/scene/particle_file.hpp"
#include "dem_server/geometry/surface.hpp"

namespace tandem::dem {

struct Fill {
  std::vector<Vec3d> position;          // of centres, world [m] (spheres x 3)
  std::vector<Vec3d> velocity;          // [m/s] (spheres x 3)
  std::vector<double> radius;           // [m] (spheres)
  std::vector<std::uint32_t> material;  // index in dem.materials (spheres)
  std::vector<std::uint32_t> group;     // index in dem.particles (spheres); groups come in order
};

struct NamedParticles {
  std::string group;  // name in dem.particles
  scene::ParticleFile file;
};

// All groups of scene.dem that move but those of inlets, in order. The same scene gives the same bits on
// every machine: random numbers are splitmix64, one stream per group. Jitter displaces a site along each
// axis, uniformly, by at most its share of half the gap between spheres, and less at the border of the fill's
// box, which no sphere crosses. In the hexagonal lattice the largest displacement is smaller by sqrt(3): its
// neighbours lie in oblique directions, along which the displacements of the three axes add up. Error{scene}:
// a count that does not fit, a group without its file or without radii.
Fill make_fill(const scene::Scene& scene, const std::vector<NamedParticles>& files);

// The spheres of the groups that are fixed, likewise. They are walls from here on.
std::vector<FixedSphere> make_fixed(const scene::Scene& scene, const std::vector<NamedParticles>& files);

// An overlap at the start of up to this share of the smaller radius is that of a settled bed (a fill from a
// file); more would throw spheres apart.
inline constexpr double start_overlap_limit = 0.01;

// What relax_start() did.
struct StartRelaxation {
  std::size_t moved = 0;    // spheres
  double largest_move = 0;  // [m]
  double worst = 0;         // overlap before, relative to the smaller radius [-]
  int sweeps = 0;
};

// Moves spheres that overlap others or walls by more than `start_overlap_limit` apart, each by at most its
// radius: sweeps over the pairs in a fixed order, each pair parted along its line, the lighter sphere moving
// more. A start without such overlaps stays as it is to the bit. Error{scene} that names the sphere for which
// there is no room.
StartRelaxation relax_start(Fill& fill, const Surface& surface, const scene::Scene& scene);

// Error{scene} that names the worst pair of spheres, or the worst sphere and wall, overlapping by more than
// `start_overlap_limit`, and for a sphere outside the domain. Bodies stand where the scene puts them. The
// same is named for any number of `threads` (0: as ThreadPool chooses).
void check_start(const Fill& fill, const Surface& surface, const scene::Scene& scene, unsigned threads = 1);

// Error{scene} that names the first sphere which starts, or comes in, at `limit` [m/s] or faster: the first
// micro step would end the run. `remedy` is what helps beside a smaller velocity.
void check_speeds(const Fill& fill, const scene::Dem& dem, double limit, const std::string& remedy = "");

// Walls are not repeated with a periodic domain: a sphere at a face meets those of its own side alone.
// Returns a warning for each body whose walls, where they stand at the start, end within a radius of such a
// face.
std::vector<std::string> warn_of_walls_at_periodic_faces(const Surface& surface, const scene::Scene& scene,
                                                         double largest_radius);

}  // namespace tandem::dem
