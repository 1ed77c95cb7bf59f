// Particles that come in and go out between two steps.
#pragma once

#include "sph_server/engine/liquid_engine_of.hpp"

namespace tandem::sph {

// Removes the entries of `leaving`, which ascend, and appends `more` ones.
template <class T>
void exchange_entries(std::span<const std::uint32_t> leaving, std::size_t more, std::vector<T>& all) {
  auto next = leaving.begin();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (next != leaving.end() && *next == i) {
      ++next;
      continue;
    }
    all[kept++] = all[i];
  }
  all.resize(kept);
  all.resize(kept + more);
}

template <class Real, bool shifting>
void LiquidEngineOf<Real, shifting>::exchange(std::span<const std::uint32_t> leaving,
                                              const LiquidState& arriving,
                                              const std::vector<particles::BodyPose>& poses) {
  rebuild();  // counts the particles that passed a wall until now
  const std::size_t more = arriving.size(), kept = position_.size() - leaving.size();
  each_particle_array([&](auto& array) { exchange_entries(leaving, more, array); });
  use_arrays();
  set_poses(poses);
  for (std::size_t k = 0; k < more; ++k) place(static_cast<std::uint32_t>(kept + k), arriving, k);
  built_at_.clear();
  rebuild();
  sum_rates();
  for (std::size_t i = kept; i < position_.size(); ++i) advance_.update_state(static_cast<std::uint32_t>(i));
  if (more > 0) sum_rates();
  begin_steps();
}

}  // namespace tandem::sph
