// Particles that have left the domain are taken out when the lists are built.
#pragma once

#include "sph_server/engine/liquid_engine_of.hpp"
#include "sph_server/equations/liquid.hpp"

namespace tandem::sph {

struct MarkInside {
  scene::Box domain;
  const Vec3d* x = nullptr;  // [m]
  std::uint32_t* inside = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const { inside[i] = is_inside(domain, x[i]) ? 1 : 0; }
};

struct MotionOfParticle {
  Vec3d velocity;          // [m/s]
  double compression = 0;  // [-]
};
template <class Real>
struct ReadMotion {
  LiquidArrays<Real> liquid;
  const std::uint32_t* index = nullptr;
  MotionOfParticle* to = nullptr;
  TANDEM_HD void operator()(std::uint32_t k) const {
    const std::uint32_t i = index[k];
    to[k] = {particles::velocity_of(liquid.velocity[i], liquid.fine_part(i)), liquid.compression[i]};
  }
};

// kept_before: number of entries before each that stay (entries + 1).
template <class T>
struct KeepEntry {
  const std::uint32_t* kept_before = nullptr;
  const T* from = nullptr;
  T* to = nullptr;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (kept_before[i + 1] != kept_before[i]) to[kept_before[i]] = from[i];
  }
};

// Particles whose positions in `located_` are outside the domain.
template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::take_out_lost() {
  exec_.grow(before_, count_ + 1);
  exec_.zero(before_, count_ + 1);
  exec_.for_each(count(), MarkInside{domain_now(), located_.data(), before_.data()});
  exec_.exclusive_sum(before_, count() + 1);
  std::vector<std::uint32_t> before(count_ + 1);
  exec_.download(before_, std::span(before));
  for (std::uint32_t i = 0; i < count(); ++i)
    if (before[i + 1] == before[i]) lost_.index.push_back(i);

  Buffer<std::uint32_t> index;
  Buffer<MotionOfParticle> read;
  std::vector<MotionOfParticle> motion(lost_.index.size());
  exec_.upload(index, std::span<const std::uint32_t>(lost_.index));
  exec_.grow(read, motion.size());
  exec_.for_each(static_cast<std::uint32_t>(motion.size()),
                 ReadMotion<Real>{liquid_, index.data(), read.data()});
  exec_.download(read, std::span(motion));
  for (const MotionOfParticle& m : motion) {
    lost_.momentum += setup_.liquid.mass() * m.velocity;
    lost_.energy += energy_of(setup_.liquid, m.velocity, m.compression);
  }

  const auto keep = [&](auto& array) {
    using T = std::remove_pointer_t<decltype(array.data())>;
    Buffer<T> kept;
    exec_.grow(kept, array.size());
    exec_.for_each(count(), KeepEntry<T>{before_.data(), array.data(), kept.data()});
    array = std::move(kept);
  };
  Memory::each([&](const char*, auto& array) { keep(array); }, memory_);
  keep(located_);
  count_ = before.back();
  use_arrays();
}

}  // namespace tandem::sph
