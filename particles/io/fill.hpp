// The spheres at the start of a run, and what must hold before it may begin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "common/scene/particle_file.hpp"
#include "particles/geometry/surface.hpp"

namespace tandem::particles {

struct Fill {
  std::vector<Vec3d> position;          // of centres, world [m] (spheres x 3)
  std::vector<Vec3d> velocity;          // [m/s] (spheres x 3)
  std::vector<Vec3d> spin;              // [rad/s] (spheres x 3)
  std::vector<double> radius;           // [m] (spheres)
  std::vector<std::uint32_t> material;  // index in dem.materials (spheres)
  std::vector<std::uint32_t> group;     // index in dem.particles (spheres); groups come in order
  // Overlaps accepted at the start, of each group of dem.particles, relative to the smaller radius [-];
  // empty: `start_overlap_limit`.
  std::vector<double> accepted_overlap;
};

struct NamedParticles {
  std::string group;  // name in dem.particles
  scene::ParticleFile file;
};

// All groups of scene.dem that move, except those of inlets, in order. The same scene gives the same bits on
// every machine: random numbers are splitmix64, one stream per group. Jitter displaces a site along each
// axis, uniformly, by at most its share of half the gap between spheres, and less at the faces of the fill's
// box, which no sphere crosses. In the hexagonal lattice the largest displacement is smaller by sqrt(3),
// because its neighbours are in oblique directions, along which the displacements of the three axes add up.
// Error{scene}: a count that does not fit, a group without its file or without radii.
Fill make_fill(const scene::Scene& scene, const std::vector<NamedParticles>& files);

// The spheres of the fixed groups, likewise. From here on they are walls.
std::vector<FixedSphere> make_fixed(const scene::Scene& scene, const std::vector<NamedParticles>& files);

// At the start, an overlap of up to this share of the smaller radius is accepted. Larger ones would throw
// spheres apart, unless they are those of a bed under its load: a file with spins has the whole state of one,
// and its overlaps may be as large as dem.overlap_limit.
inline constexpr double start_overlap_limit = 0.01;

// Result of relax_start().
struct StartRelaxation {
  std::size_t moved = 0;    // spheres
  double largest_move = 0;  // [m]
  double worst = 0;         // largest overlap before, relative to the smaller radius [-]
  int sweeps = 0;
};

// Moves spheres apart that overlap others or walls by more than `start_overlap_limit`, each by at most its
// radius: sweeps over the pairs in a fixed order separate each pair along its line of centres, the lighter
// sphere moving more. A start without such overlaps stays the same to the bit. Error{scene} names a sphere
// for which there is no room.
StartRelaxation relax_start(Fill& fill, const Surface& surface, const scene::Scene& scene);

// Error{scene} names the worst pair of spheres, or the worst sphere and wall, that overlap by more than
// is accepted, or a sphere outside the domain. Bodies are at their poses of the scene. The result
// does not depend on the number of `threads` (0: as ThreadPool chooses).
void check_start(const Fill& fill, const Surface& surface, const scene::Scene& scene, unsigned threads = 1);

// Error{scene} names the first sphere which starts, or comes in, at `limit` [m/s] or faster: the first micro
// step would end the run. `remedy` is appended to the advice of a smaller velocity.
void check_speeds(const Fill& fill, const scene::Dem& dem, double limit, const std::string& remedy = "");

// Error{scene} names the first sphere whose surface moves with `limit` [m/s] or faster by its spin.
void check_spins(const Fill& fill, const scene::Dem& dem, double limit);

// Walls are not repeated with a periodic domain: a sphere at a face touches only those of its own side.
// Returns a warning for each body whose walls, at their start poses, end within a radius of such a face.
std::vector<std::string> warn_of_walls_at_periodic_faces(const Surface& surface, const scene::Scene& scene,
                                                         double largest_radius);

}  // namespace tandem::particles
