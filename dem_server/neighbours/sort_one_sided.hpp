// The end of a rebuild: rests and ids, which have one side, go into the order of the new slots. After
// FinishRebuild nobody needs the former side of places and drifts, so they are put there, and taken up from
// there.
#pragma once

#include <cstdint>
#include <new>

#include "dem_server/neighbours/build.hpp"

namespace tandem::dem {

struct alignas(16) IdAside {
  Vec3<std::uint32_t> centre;  // of Rest
  std::uint32_t id;
};
struct alignas(16) VelocityAside {
  Vec3f v;  // of Rest
};

template <class Real>
struct SetAside {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.control->progress[0].state_side ^ 1, from = view.source[i];
    static_assert(sizeof(IdAside) <= sizeof(Place<Real>) && sizeof(VelocityAside) <= sizeof(Drift<Real>));
    IdAside aside{{}, view.id[from]};
    if constexpr (has_rest<Real>) {
      const Rest<Real> rest = view.rest[from];
      aside.centre = rest.centre;
      new (view.drift[former] + i) VelocityAside{rest.v};
    }
    new (view.place[former] + i) IdAside(aside);
  }
};

template <class Real>
struct TakeUp {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.control->progress[0].state_side ^ 1;
    const auto aside = *reinterpret_cast<const IdAside*>(view.place[former] + i);
    view.id[i] = aside.id;
    if constexpr (has_rest<Real>)
      view.rest[i] = {aside.centre, reinterpret_cast<const VelocityAside*>(view.drift[former] + i)->v};
  }
};

}  // namespace tandem::dem
