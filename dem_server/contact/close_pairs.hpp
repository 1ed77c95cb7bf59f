// Pairs that may touch soon; the CPU only. Half of the listed pairs do not touch before the lists are
// rebuilt, and testing every listed pair in every step costs more than the forces of the pairs in contact.
// The lists are therefore searched every few steps, for the pairs that may touch before the next search.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/view.hpp"

namespace tandem::dem {

inline constexpr std::uint32_t not_close = ~0u;

// Finds the pairs owned by a range of spheres that may touch before any two spheres have approached by
// `margin`. Their order is that of the lists. The range uses as many numbers as its lists have entries.
template <class Law, class Real>
void find_close_pairs(const View<Real>& view, const CurrentStep& now, Range spheres,
                      typename LengthUnit<Real>::Count margin) {
  const ClosePairs<Real>& close = view.close;
  const PairList<Real>& list = view.lists.pairs;
  const PositionRadius<Real>* position = view.spheres.position[now.state_side];
  std::uint32_t found = list.start[spheres.begin];
  for (std::uint32_t i = spheres.begin; i < spheres.end; ++i) {
    close.owned[i].begin = found;
    for (std::uint32_t k = list.start[i]; k < list.start[i + 1]; ++k) {
      PositionRadius<Real> own = position[i], other = position[list.entry[k].index()];
      if constexpr (Law::extended)
        if (list.image != nullptr) view.parameters.unwrap_pair(own, other, list.image[k]);
      // A pair that has just separated is kept, because its contact has to end.
      const bool is_close =
          (Law::tangential && list.entry[k].in_contact()) | Approach<Real>::may_touch(own, other, margin);
      close.pair[found] = {i, k};
      close.number[k] = is_close ? found : not_close;
      found += is_close ? 1 : 0;  // no branch, as it would be mispredicted often
    }
    close.owned[i].end = found;
  }
}

// The close pairs in which the spheres of a range are the other one, in the order of the mirrors.
template <class Real>
void find_close_mirrors(const View<Real>& view, Range spheres) {
  const ClosePairs<Real>& close = view.close;
  std::uint32_t found = view.lists.mirror_start[spheres.begin];
  for (std::uint32_t i = spheres.begin; i < spheres.end; ++i) {
    close.mirrored[i].begin = found;
    for (std::uint32_t m = view.lists.mirror_start[i]; m < view.lists.mirror_start[i + 1]; ++m) {
      const std::uint32_t number = close.number[view.lists.mirror[m]];
      close.mirror[found] = number;
      found += number != not_close ? 1 : 0;
    }
    close.mirrored[i].end = found;
  }
}

}  // namespace tandem::dem
