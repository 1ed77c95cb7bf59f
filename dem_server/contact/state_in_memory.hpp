// Reads and writes the spheres in a micro step. The functors of a step are written against this interface;
// backend/cuda/resident/resident.cuh has the other implementation, in a GPU's shared memory.
#pragma once

#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/fetch.hpp"
#include "particles/geometry/touch_facet.hpp"

namespace tandem::dem {

// The facets listed for a sphere and a body.
struct ListedFacets {
  const std::uint32_t* entry;
  const float* slack;  // [m]
  float travel;        // bound of their approach since the list was built [m]

  TANDEM_HD std::uint32_t operator[](int i) const { return fetch(entry + i); }
};
TANDEM_HD inline bool touches_facet(const ListedFacets& near, int i, Vec3d centre_B, double radius,
                                    const Facet* facets, WallContact& k) {
  return !(fetch(near.slack + i) > near.travel) && touch_facet(facets, near[i], centre_B, radius, k);
}

// The arrays of a View: a step reads one side and writes the other. These are plain pointers, so that a loop
// keeps them in registers.
template <class Real>
struct StateInMemory {
  const PositionRadius<Real>* positions;
  const VelocityKind<Real>* velocities;
  const Spin<Real>* spins;
  FinePart<Real>* fine_parts;
  PositionRadius<Real>* next_positions;
  VelocityKind<Real>* next_velocities;
  Spin<Real>* next_spins;
  Neighbour* neighbours;
  const std::uint32_t* wall_entries;
  const float* wall_slack;
  WallForce<Real>* wall_forces;

  TANDEM_HD StateInMemory(const View<Real>& view, const CurrentStep& now)
      : positions(view.spheres.position[now.state_side]),
        velocities(view.spheres.velocity[now.state_side]),
        spins(view.spheres.spin[now.state_side]),
        fine_parts(view.spheres.fine),
        next_positions(view.spheres.position[now.state_side ^ 1]),
        next_velocities(view.spheres.velocity[now.state_side ^ 1]),
        next_spins(view.spheres.spin[now.state_side ^ 1]),
        neighbours(view.lists.pairs.entry),
        wall_entries(view.lists.walls.entry),
        wall_slack(view.lists.wall_slack),
        wall_forces(view.wall_force) {}

  TANDEM_HD PositionRadius<Real> position(std::uint32_t i) const { return fetch(positions + i); }
  TANDEM_HD VelocityKind<Real> velocity(std::uint32_t i) const { return fetch(velocities + i); }
  TANDEM_HD std::uint32_t kind(std::uint32_t i) const { return fetch(&velocities[i].label).kind(); }
  TANDEM_HD Spin<Real> spin(std::uint32_t i) const { return fetch(spins + i); }
  TANDEM_HD FinePart<Real> fine(std::uint32_t i) const {
    if constexpr (has_fine_part<Real>)
      return fetch(fine_parts + i);
    else
      return {};
  }
  // Pair entry k.
  TANDEM_HD Neighbour neighbour(std::size_t k) const { return fetch(neighbours + k); }
  // Facets of a body near a sphere, from wall entry `first_facet` on.
  TANDEM_HD ListedFacets facets(std::uint32_t first_facet, const CurrentStep& now) const {
    return {wall_entries + first_facet, wall_slack + first_facet, static_cast<float>(now.wall_travel)};
  }
  // Force found in this step for entry `which` of `near`, a sphere and a body near it.
  TANDEM_HD const WallForce<Real>& wall_force(std::uint32_t which) const { return wall_forces[which]; }

  TANDEM_HD void set_wall_force(std::uint32_t which, const WallForce<Real>& force) const {
    store(wall_forces + which, force);
  }
  // Only the thread that owns entry k reads or writes it within a step; it has read it before.
  TANDEM_HD void set_neighbour(std::uint32_t k, Neighbour other) const { neighbours[k] = other; }
  TANDEM_HD void move(std::uint32_t i, const PositionRadius<Real>& position,
                      const VelocityKind<Real>& velocity) const {
    next_positions[i] = position;
    next_velocities[i] = velocity;
  }
  TANDEM_HD void set_spin(std::uint32_t i, const Spin<Real>& spin) const { next_spins[i] = spin; }
  TANDEM_HD void set_fine_part(std::uint32_t i, const FinePart<Real>& fine) const {
    if constexpr (has_fine_part<Real>) fine_parts[i] = fine;
  }
};

}  // namespace tandem::dem
