#include "dem_server/coupling/state_hash.hpp"

#include "dem_server/laws/particle_names.hpp"
#include "particles/serving/state_digest.hpp"

namespace tandem::dem {

std::string state_hash(const Spheres& s) {
  StateDigest digest;
  for (std::size_t i = 0; i < s.size(); ++i) {
    digest.mix(std::uint64_t{s.id[i]});
    for (const Vec3d& v : {s.position[i], s.velocity[i], s.spin[i]}) digest.mix(v);
  }
  return digest.text();
}

}  // namespace tandem::dem
