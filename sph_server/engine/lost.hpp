// Particles that have left the domain are taken out when the lists are built.
#pragma once

#include "sph_server/engine/liquid_engine_of.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct LostCount {
  std::uint32_t particles = 0;
  TANDEM_HD void add(const LostCount& b) { particles += b.particles; }
};
struct MarkInside {
  scene::Box domain;
  const Vec3d* x = nullptr;                              // [m]
  const std::uint32_t* number = nullptr;                 // of each particle
  std::uint32_t *entry = nullptr, *by_number = nullptr;  // 1: of a particle inside the domain
  TANDEM_HD void operator()(std::uint32_t i, LostCount& lost) const {
    entry[i] = by_number[number[i]] = is_inside(domain, x[i]) ? 1 : 0;
    lost.particles += 1 - entry[i];
  }
};

struct LostParticle {
  std::uint32_t number = 0;
  Vec3d velocity;          // [m/s]
  double compression = 0;  // [-]
};
// Lists the particles that stay, and by their numbers those that do not.
template <class Real>
struct PartLost {
  LiquidArrays<Real> liquid;
  // How many stay before each entry, and before each number (particles + 1).
  const std::uint32_t *before = nullptr, *before_number = nullptr;
  std::uint32_t* kept = nullptr;
  LostParticle* lost = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t number = liquid.number[i];
    if (before[i + 1] != before[i]) {
      kept[before[i]] = i;
      liquid.number[i] = before_number[number];
    } else {
      lost[number - before_number[number]] = {
          number, particles::velocity_of(liquid.velocity[i], liquid.fine_part(i)), liquid.compression[i]};
    }
  }
};

// Particles whose positions in `located_` are outside the domain.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::take_out_lost() {
  Buffer<std::uint32_t> before_number, kept;
  for (auto* before : {&before_, &before_number}) {
    exec_.grow(*before, count_ + 1);
    exec_.zero(*before, count_ + 1);
  }
  const std::uint32_t lost = exec_
                                 .template reduce<LostCount>(
                                     count(), MarkInside{domain_now(), located_.data(), memory_.number.data(),
                                                         before_.data(), before_number.data()})
                                 .particles;
  exec_.exclusive_sum(before_, count() + 1);
  exec_.exclusive_sum(before_number, count() + 1);
  Buffer<LostParticle> found;
  exec_.grow(found, lost);
  exec_.grow(kept, count_);
  exec_.for_each(count(),
                 PartLost<Real>{liquid_, before_.data(), before_number.data(), kept.data(), found.data()});
  std::vector<LostParticle> left(lost);
  exec_.download(found, std::span(left));
  for (const LostParticle& p : left) {
    lost_.index.push_back(p.number);
    lost_.momentum += setup_.liquid.mass() * p.velocity;
    lost_.energy += energy_of(setup_.liquid, p.velocity, p.compression);
  }
  take(kept, count_ - lost);
}

}  // namespace tandem::sph
