// Particles that come in and go out between two steps.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

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

// Entry i becomes entry number[i].
template <class T>
void put_in_order(const std::vector<std::uint32_t>& number, std::vector<T>& all) {
  std::vector<T> ordered(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) ordered[number[i]] = all[i];
  all = std::move(ordered);
}

template <class Exec, class Real, bool shifting>
void LiquidEngineOf<Exec, Real, shifting>::exchange(std::span<const std::uint32_t> leaving,
                                                    const LiquidState& arriving,
                                                    const std::vector<particles::BodyPose>& poses) {
  lost_ = {};
  figures_.passed_walls += locate_particles().passed;
  Host host = download();
  const std::vector<std::uint32_t> number = host.number;
  each(host, [&](auto& array) { put_in_order(number, array); });
  const std::size_t more = arriving.size(), kept = count_ - leaving.size();
  each(host, [&](auto& array) { exchange_entries(leaving, more, array); });
  std::iota(host.number.begin(), host.number.end(), 0u);
  for (std::size_t k = 0; k < more; ++k) place(host, static_cast<std::uint32_t>(kept + k), arriving, k);
  upload(host);
  set_poses(poses);
  built_ = false;
  rebuild();
  sum_rates();
  if (more > 0) {
    // The tension that the new ones bear follows from what fills their kernels.
    exec_.for_each(count(), UpdateState<Real>{advance_, static_cast<std::uint32_t>(kept)});
    sum_rates();
  }
  begin_steps();
}

}  // namespace tandem::sph
