// The end of a rebuild: remainders, and ids that are not in Spin, have one side, and go into the order of the
// new indices. After FinishRebuild nobody needs the former side of places and drifts, so they are put there,
// and taken up from there.
#pragma once

#include <cstdint>
#include <new>

#include "dem_server/neighbours/build.hpp"

namespace tandem::dem {

struct alignas(16) SavedPosition {
  Vec3<std::uint32_t> fine_position;
  std::uint32_t id = 0;
};
struct alignas(16) SavedVelocity {
  Vec3f fine_velocity;
};

template <class Real, class Law>
struct SaveSingleBuffered {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.window->progress[0].state_side ^ 1, from = view.rebuild.source[i];
    static_assert(sizeof(SavedPosition) <= sizeof(PositionRadius<Real>) &&
                  sizeof(SavedVelocity) <= sizeof(VelocityKind<Real>));
    SavedPosition aside;
    if constexpr (!Law::tangential) aside.id = view.spheres.id[from];
    if constexpr (has_fine_part<Real>) {
      const FinePart<Real> fine = view.spheres.fine[from];
      aside.fine_position = fine.fine_position;
      new (view.spheres.velocity[former] + i) SavedVelocity{fine.fine_velocity};
    }
    new (view.spheres.position[former] + i) SavedPosition(aside);
  }
};

template <class Real, class Law>
struct ReorderSingleBuffered {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.window->progress[0].state_side ^ 1;
    const auto aside = *reinterpret_cast<const SavedPosition*>(view.spheres.position[former] + i);
    if constexpr (!Law::tangential) view.spheres.id[i] = aside.id;
    if constexpr (has_fine_part<Real>)
      view.spheres.fine[i] = {
          aside.fine_position,
          reinterpret_cast<const SavedVelocity*>(view.spheres.velocity[former] + i)->fine_velocity};
  }
};

}  // namespace tandem::dem
