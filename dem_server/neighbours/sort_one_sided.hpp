// The end of a rebuild: remainders, and ids that are not in Spin, have one side, and go into the order of the
// new slots. After FinishRebuild nobody needs the former side of places and drifts, so they are put there,
// and taken up from there.
#pragma once

#include <cstdint>
#include <new>

#include "dem_server/neighbours/build.hpp"

namespace tandem::dem {

struct alignas(16) PlaceAside {
  Vec3<std::uint32_t> of_place;
  std::uint32_t id = 0;
};
struct alignas(16) DriftAside {
  Vec3f of_drift;
};

template <class Real, class Law>
struct SetAside {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.control->progress[0].state_side ^ 1, from = view.source[i];
    static_assert(sizeof(PlaceAside) <= sizeof(Place<Real>) && sizeof(DriftAside) <= sizeof(Drift<Real>));
    PlaceAside aside;
    if constexpr (!Law::tangential) aside.id = view.id[from];
    if constexpr (has_remainder<Real>) {
      const Remainder<Real> remainder = view.remainder[from];
      aside.of_place = remainder.of_place;
      new (view.drift[former] + i) DriftAside{remainder.of_drift};
    }
    new (view.place[former] + i) PlaceAside(aside);
  }
};

template <class Real, class Law>
struct TakeUp {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.control->progress[0].state_side ^ 1;
    const auto aside = *reinterpret_cast<const PlaceAside*>(view.place[former] + i);
    if constexpr (!Law::tangential) view.id[i] = aside.id;
    if constexpr (has_remainder<Real>)
      view.remainder[i] = {aside.of_place,
                           reinterpret_cast<const DriftAside*>(view.drift[former] + i)->of_drift};
  }
};

}  // namespace tandem::dem
