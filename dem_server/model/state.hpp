// Where a micro step finds the spheres and leaves them moved. The functors of a step are written against this
// interface; core/resident.cuh has the other one, of a GPU's shared memory.
#pragma once

#include "dem_server/core/fetch.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

// The facets listed for a sphere and a body.
struct ListedFacets {
  const std::uint32_t* entry;
  const float* slack;  // [m]
  float travel;        // how much nearer they may have come since the list was built [m]

  TANDEM_HD std::uint32_t operator[](int i) const { return fetch(entry + i); }
};
TANDEM_HD inline bool within_reach(const ListedFacets& near, int i) {
  return !(fetch(near.slack + i) > near.travel);
}

// The arrays of a View: a step reads one side and writes the other.
template <class Real>
struct StateInMemory {
  const View<Real>& view;
  std::uint32_t side, list_side;

  TANDEM_HD StateInMemory(const View<Real>& of, const Instant& now)
      : view(of), side(now.state_side), list_side(now.list_side) {}

  TANDEM_HD Place<Real> place(std::uint32_t i) const { return fetch(view.place[side] + i); }
  TANDEM_HD Drift<Real> drift(std::uint32_t i) const { return fetch(view.drift[side] + i); }
  TANDEM_HD std::uint32_t kind(std::uint32_t i) const { return fetch(&view.drift[side][i].kind); }
  TANDEM_HD Spin<Real> spin(std::uint32_t i) const { return fetch(view.spin[side] + i); }
  TANDEM_HD Exact exact(std::uint32_t i) const { return fetch(view.exact[list_side] + i); }
  // The slot of the other sphere of pair entry k.
  TANDEM_HD std::uint32_t neighbour(std::uint32_t k) const { return fetch(view.pairs[list_side].entry + k); }
  // Of a body near a sphere, from wall entry `first_facet` on.
  TANDEM_HD ListedFacets facets(std::uint32_t first_facet, const Instant& now) const {
    return {view.walls[list_side].entry + first_facet, view.wall_slack + first_facet,
            static_cast<float>(now.wall_travel)};
  }
  // Found in this step, for pair `which` of a sphere and a body near it.
  TANDEM_HD WallForce<Real>& wall_force(std::uint32_t which) const { return view.wall_force[which]; }

  TANDEM_HD void move(std::uint32_t i, const Place<Real>& place, const Drift<Real>& drift) const {
    view.place[side ^ 1][i] = place;
    view.drift[side ^ 1][i] = drift;
  }
  TANDEM_HD void turn(std::uint32_t i, const Spin<Real>& spin) const { view.spin[side ^ 1][i] = spin; }
  TANDEM_HD void remember(std::uint32_t i, const Exact& exact) const { view.exact[list_side][i] = exact; }
};

}  // namespace tandem::dem
