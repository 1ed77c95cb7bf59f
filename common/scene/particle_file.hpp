// Particle files: CSV with a header, x,y,z[,radius][,vx,vy,vz][,wx,wy,wz], one sphere per line, SI units.
#pragma once

#include <string>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::scene {

struct ParticleFile {
  std::vector<Vec3d> positions;   // [m] (spheres x 3)
  std::vector<double> radii;      // [m] (spheres), or empty: the file has no such column
  std::vector<Vec3d> velocities;  // [m/s] (spheres x 3), or empty
  std::vector<Vec3d> spins;       // [rad/s] (spheres x 3), or empty
};

// `origin` names the text in errors, which contain the line number.
ParticleFile read_particle_file(const std::string& text, const std::string& origin);

// The text from which the same numbers are read again.
std::string particle_file_text(const ParticleFile& file);

}  // namespace tandem::scene
