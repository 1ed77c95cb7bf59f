// The end of a rebuild: fine parts, and ids that are not in Spin, are single buffered and have to be sorted
// by the new indices. After FinishRebuild no pass reads the former side of positions and velocities, so it
// serves as temporary memory.
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
    SavedPosition saved;
    if constexpr (!Law::tangential) saved.id = view.spheres.id[from];
    if constexpr (has_fine_part<Real>) {
      const FinePart<Real> fine = view.spheres.fine[from];
      saved.fine_position = fine.fine_position;
      new (view.spheres.velocity[former] + i) SavedVelocity{fine.fine_velocity};
    }
    new (view.spheres.position[former] + i) SavedPosition(saved);
  }
};

template <class Real, class Law>
struct ReorderSingleBuffered {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const std::uint32_t former = view.window->progress[0].state_side ^ 1;
    const auto saved = *reinterpret_cast<const SavedPosition*>(view.spheres.position[former] + i);
    if constexpr (!Law::tangential) view.spheres.id[i] = saved.id;
    if constexpr (has_fine_part<Real>)
      view.spheres.fine[i] = {
          saved.fine_position,
          reinterpret_cast<const SavedVelocity*>(view.spheres.velocity[former] + i)->fine_velocity};
  }
};

}  // namespace tandem::dem
