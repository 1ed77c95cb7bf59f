// Particles that leave the liquid: outside the domain, which is seen when the lists are built, or in an
// outlet.
#pragma once

#include "sph_server/engine/liquid_engine_of.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct LostCount {
  std::uint32_t particles = 0;
  TANDEM_HD void add(const LostCount& b) { particles += b.particles; }
};
struct IsInDomain {
  scene::Box domain;
  const Vec3d* x = nullptr;  // [m]
  TANDEM_HD bool operator()(std::uint32_t i) const { return is_inside(domain, x[i]); }
};
template <class Real>
struct IsInNoOutlet {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  const particles::OutletRegion* region = nullptr;
  std::uint32_t regions = 0;
  TANDEM_HD bool operator()(std::uint32_t i) const {
    const Vec3d x = centres.metres(centres.joined(liquid.position[i], liquid.fine_part(i)));
    for (std::uint32_t k = 0; k < regions; ++k)
      if (region[k].contains(x)) return false;
    return true;
  }
};
template <class Stays>
struct MarkStaying {
  Stays stays;
  const std::uint32_t* number = nullptr;                 // of each particle
  std::uint32_t *entry = nullptr, *by_number = nullptr;  // 1: of a particle that stays
  TANDEM_HD void operator()(std::uint32_t i, LostCount& lost) const {
    entry[i] = by_number[number[i]] = stays(i) ? 1 : 0;
    lost.particles += 1 - entry[i];
  }
};

// Lists the particles that stay, and by their numbers those that do not.
template <class Real>
struct PartLost {
  LiquidArrays<Real> liquid;
  particles::CentreUnit<Real> centres;
  // How many stay before each entry, and before each number (particles + 1).
  const std::uint32_t *before = nullptr, *before_number = nullptr;
  std::uint32_t* kept = nullptr;
  TakenParticle* lost = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    const std::uint32_t number = liquid.number[i];
    if (before[i + 1] != before[i]) {
      kept[before[i]] = i;
      liquid.number[i] = before_number[number];
    } else {
      const particles::FinePart<Real> fine = liquid.fine_part(i);
      lost[number - before_number[number]] = {
          number, centres.metres(centres.joined(liquid.position[i], fine)),
          particles::velocity_of(liquid.velocity[i], fine), liquid.compression[i]};
    }
  }
};

// Marks the particles for which stays(i) holds in `stay_before_` and `stay_before_number_`, and returns how
// many others there are.
template <class Exec, class Real, bool shifting>
template <class Stays>
std::uint32_t LiquidEngineOf<Exec, Real, shifting>::mark_staying(Stays stays) {
  for (auto* before : {&stay_before_, &stay_before_number_}) {
    exec_.grow(*before, count_ + 1);
    exec_.zero(*before, count_ + 1);
  }
  return exec_
      .template reduce<LostCount>(
          count(),
          MarkStaying<Stays>{stays, memory_.number.data(), stay_before_.data(), stay_before_number_.data()})
      .particles;
}

template <class Exec, class Real, bool shifting>
std::vector<TakenParticle> LiquidEngineOf<Exec, Real, shifting>::take_unmarked(std::uint32_t particles) {
  exec_.exclusive_sum(stay_before_, count() + 1);
  exec_.exclusive_sum(stay_before_number_, count() + 1);
  Buffer<std::uint32_t> kept;
  Buffer<TakenParticle> found;
  exec_.grow(kept, count_);
  exec_.grow(found, particles);
  exec_.for_each(count(), PartLost<Real>{liquid_, centres_, stay_before_.data(), stay_before_number_.data(),
                                         kept.data(), found.data()});
  std::vector<TakenParticle> taken(particles);
  exec_.download(found, std::span(taken));
  take(kept, count_ - particles);
  return taken;
}

// Particles whose positions in `located_` are outside the domain.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::take_out_lost() {
  for (const TakenParticle& p : take_unmarked(mark_staying(IsInDomain{domain_now(), located_.data()}))) {
    lost_.index.push_back(p.number);
    lost_.momentum += setup_.liquid.mass() * p.velocity;
    lost_.energy += energy_of(setup_.liquid, p.velocity, p.compression);
  }
}

template <class Exec, class Real, bool shifting>
std::vector<TakenParticle> LiquidEngineOf<Exec, Real, shifting>::take_out(
    const std::vector<particles::OutletRegion>& regions) {
  exec_.upload(outlets_, std::span<const particles::OutletRegion>(regions));
  const std::uint32_t particles = mark_staying(
      IsInNoOutlet<Real>{liquid_, centres_, outlets_.data(), static_cast<std::uint32_t>(regions.size())});
  if (particles == 0) return {};
  lost_ = {};
  figures_.passed_walls += locate_particles().passed;
  std::vector<TakenParticle> taken = take_unmarked(particles);
  built_ = false;
  rebuild();
  sum_rates();
  begin_steps();
  return taken;
}

}  // namespace tandem::sph
