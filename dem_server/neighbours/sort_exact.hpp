// The end of a rebuild: Exact and ids, which have one side, go into the order of the new slots. After
// FinishRebuild the former side of places and drifts has room for half of Exact and more; so places and ids
// are put there, taken over while velocities are put there, and these are taken over.
#pragma once

#include <cstdint>
#include <new>

#include "dem_server/neighbours/build.hpp"

namespace tandem::dem {

struct alignas(16) SetAside {
  double x, y;
};
struct alignas(16) SetAsideBeside {
  double z;
  std::uint32_t id;
};
template <class Real>
class Aside {
 public:
  TANDEM_HD Aside(const View<Real>& view, std::uint32_t i) {
    static_assert(sizeof(SetAside) <= sizeof(Place<Real>) && sizeof(SetAsideBeside) <= sizeof(Drift<Real>));
    const std::uint32_t former = view.control->progress[0].state_side ^ 1;
    in_place_ = view.place[former] + i;
    in_drift_ = view.drift[former] + i;
  }
  TANDEM_HD void put(Vec3d v, std::uint32_t id) const {
    new (in_place_) SetAside{v.x, v.y};
    new (in_drift_) SetAsideBeside{v.z, id};
  }
  TANDEM_HD Vec3d vector() const {
    const SetAside xy = *static_cast<const SetAside*>(in_place_);
    return {xy.x, xy.y, beside().z};
  }
  TANDEM_HD std::uint32_t id() const { return beside().id; }

 private:
  TANDEM_HD const SetAsideBeside& beside() const { return *static_cast<const SetAsideBeside*>(in_drift_); }
  void *in_place_, *in_drift_;
};

template <class Real, class Law>
struct SetPlacesAside {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (lists_fit(view)) Aside<Real>(view, i).put(centre_of<Law>(view, i), view.id[view.source[i]]);
  }
};
template <class Real>
struct SortPlaces {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (!lists_fit(view)) return;
    const Aside<Real> aside(view, i);
    view.exact[i].x = aside.vector();
    view.id[i] = aside.id();
    aside.put(view.exact[view.source[i]].v, 0);
  }
};
template <class Real>
struct SortVelocities {
  View<Real> view;
  TANDEM_HD void operator()(std::uint32_t i) const {
    if (lists_fit(view)) view.exact[i].v = Aside<Real>(view, i).vector();
  }
};

}  // namespace tandem::dem
