// The lists of pairs and of walls near spheres, with the springs of their contacts, and what the entries of
// one micro step exert.
#pragma once

#include <cstdint>

#include "dem_server/geometry/periods.hpp"
#include "dem_server/laws/history.hpp"
#include "dem_server/state/particles.hpp"

namespace tandem::dem {

// An entry of the pair lists: the other sphere and, where the law has friction, whether the two touched in
// the last micro step, that is: whether spring and turn of the entry mean anything.
struct Neighbour {
  static constexpr std::uint32_t contact_bit = 1u << 31;  // beyond all indices
  std::uint32_t word = 0;

  TANDEM_HD static Neighbour of(std::uint32_t index, bool in_contact) {
    return {index | (in_contact ? contact_bit : 0)};
  }
  TANDEM_HD std::uint32_t index() const { return word & ~contact_bit; }
  TANDEM_HD bool in_contact() const { return word >= contact_bit; }
};

// Entries of sphere i are [start[i], start[i+1]). Where pairs are evaluated once, a pair of spheres has one
// entry, in the list of the one at the lower index; else each of the two has one.
template <class Real>
struct PairList {
  std::uint32_t* start = nullptr;  // (n + 1)
  Neighbour* entry = nullptr;
  // Elastic tangential displacement relative to the other sphere; absent for laws without friction [m]
  Vec3<Real>* spring = nullptr;            // there is room behind them, see carried_contact()
  RollingSpring<Real>* rolling = nullptr;  // of each entry, where the scene has rolling or twisting
  Image* image = nullptr;                  // of the other sphere, where the domain is periodic
};

// The same of the facets near spheres. Entries of a sphere and a body are those that a NearBody says.
template <class Real>
struct WallList {
  std::uint32_t* entry = nullptr;          // facet
  History<Real>* history = nullptr;        // absent for laws without friction
  RollingSpring<Real>* rolling = nullptr;  // where the scene has rolling or twisting
};

// What the contact of a pair does to the sphere that owns it; the other one feels the opposite.
template <class Real>
struct alignas(4 * sizeof(Real)) PairForce {
  Vec3<Real> force;  // [N]
  Real overlap = 0;  // [m]
};
// Friction turns both the same way: the torque about a centre is this times the centre's distance from the
// contact.
template <class Real>
struct alignas(4 * sizeof(Real)) PairCouple {
  Vec3<Real> per_arm;  // [N]
};
// Rolling and twisting, of which the other one feels the opposite.
template <class Real>
struct alignas(4 * sizeof(Real)) PairMoment {
  Vec3<Real> moment;  // [N m]
};

// Numbers [begin, end).
struct Range {
  std::uint32_t begin = 0, end = 0;
};

struct ClosePair {
  std::uint32_t owner = 0;  // index
  std::uint32_t entry = 0;  // in the owner's list
};

// Of pairs that are evaluated once, those that may touch soon (contact/close_pairs.hpp).
template <class Real>
struct ClosePairs {
  ClosePair* pair = nullptr;        // by number
  std::uint32_t* number = nullptr;  // of each pair entry
  Range* owned = nullptr;           // numbers of the pairs that a sphere owns (n)
  std::uint32_t* mirror = nullptr;  // numbers of the pairs in which a sphere is the other one
  Range* mirrored = nullptr;        // of each sphere in `mirror` (n)
  // Of the present step, by number; zero where the two do not touch.
  PairForce<Real>* force = nullptr;
  PairCouple<Real>* couple = nullptr;  // absent for laws without friction
  PairMoment<Real>* moment = nullptr;  // where the scene has rolling or twisting
};

// A sphere and a body near it: `count` entries of the wall list from `first` on.
struct alignas(16) NearBody {
  std::uint32_t sphere = 0, body = 0;
  std::uint32_t first = 0, count = 0;
};

// Of that body's walls on that sphere.
template <class Real>
struct alignas(16) WallForce {
  Vec3d force;        // [N]
  Vec3<Real> torque;  // about the sphere's centre [N m]

  TANDEM_HD WallForce& operator+=(const WallForce& b) {
    force += b.force;
    torque += b.torque;
    return *this;
  }
};

template <class Real>
struct ContactLists {
  PairList<Real> pairs;
  WallList<Real> walls;
  // Where pairs are evaluated once:
  std::uint32_t* mirror_start = nullptr;  // of each sphere in `mirror` (n + 1)
  std::uint32_t* mirror = nullptr;        // entries in which a sphere is the other one (pair entries)

  float* wall_slack = nullptr;        // of each wall entry: nearer by less, and it does not touch [m]
  NearBody* near = nullptr;           // in the order of spheres (window->near)
  std::uint32_t spring_capacity = 0;  // as large as can be where there are none
  std::uint32_t pair_capacity = 0, wall_capacity = 0, near_capacity = 0;
};

}  // namespace tandem::dem
