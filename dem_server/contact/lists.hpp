// The lists of pairs and of walls near spheres, the springs of their contacts, and the forces of the entries
// in one micro step.
#pragma once

#include <cstdint>

#include "dem_server/laws/history.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/base/range.hpp"
#include "particles/geometry/periods.hpp"
#include "particles/state/particles.hpp"

namespace tandem::dem {

// An entry of a pair list: the other sphere and, for laws with friction, whether the two were in contact in
// the last micro step. Only then are the springs of the entry valid.
struct Neighbour {
  static constexpr std::uint32_t contact_bit = 1u << 31;  // above all indices
  std::uint32_t word = 0;

  TANDEM_HD static Neighbour of(std::uint32_t index, bool in_contact) {
    return {index | (in_contact ? contact_bit : 0)};
  }
  TANDEM_HD std::uint32_t index() const { return word & ~contact_bit; }
  TANDEM_HD bool in_contact() const { return word >= contact_bit; }
};

// Entries of sphere i are [start[i], start[i+1]). A back end that evaluates each pair once has one entry per
// pair, in the list of the sphere with the lower index; otherwise each of the two spheres has one.
template <class Real>
struct PairList {
  std::uint32_t* start = nullptr;  // (n + 1)
  Neighbour* entry = nullptr;
  // Elastic tangential displacement relative to the other sphere; absent for laws without friction [m]
  Vec3<Real>* spring = nullptr;            // memory continues behind them, see carried_contact()
  RollingSpring<Real>* rolling = nullptr;  // of each entry, in scenes with rolling or twisting
  Image* image = nullptr;                  // image of the other sphere, in periodic domains
};

// The facets near spheres. NearBody holds the range of entries of one sphere and one body.
template <class Real>
struct WallList {
  std::uint32_t* entry = nullptr;          // facet
  History<Real>* history = nullptr;        // absent for laws without friction
  RollingSpring<Real>* rolling = nullptr;  // in scenes with rolling or twisting
};

// Force of a pair on the sphere that owns it; the other sphere receives the opposite force.
template <class Real>
struct alignas(4 * sizeof(Real)) PairForce {
  Vec3<Real> force;  // [N]
  Real overlap = 0;  // [m]
};
// Friction acts with the same sense of rotation on both spheres: the torque about a centre is per_arm times
// the distance of that centre from the contact.
template <class Real>
struct alignas(4 * sizeof(Real)) PairCouple {
  Vec3<Real> per_arm;  // [N]
};
// Rolling and twisting moment on the owner; the other sphere receives the opposite moment.
template <class Real>
struct alignas(4 * sizeof(Real)) PairMoment {
  Vec3<Real> moment;  // [N m]
};

struct ClosePair {
  std::uint32_t owner = 0;  // index
  std::uint32_t entry = 0;  // in the owner's list
};

// Those pairs, each evaluated once, that may touch soon (contact/close_pairs.hpp).
template <class Real>
struct ClosePairs {
  ClosePair* pair = nullptr;        // by number
  std::uint32_t* number = nullptr;  // of each pair entry
  Range* owned = nullptr;           // numbers of the pairs that a sphere owns (n)
  std::uint32_t* mirror = nullptr;  // numbers of the pairs in which a sphere is the other one
  Range* mirrored = nullptr;        // range of each sphere in `mirror` (n)
  // Results of the present step by number; zero for pairs that are not in contact.
  PairForce<Real>* force = nullptr;
  PairCouple<Real>* couple = nullptr;  // absent for laws without friction
  PairMoment<Real>* moment = nullptr;  // in scenes with rolling or twisting
};

// A sphere and a body near it: `count` entries of the wall list from `first` on.
struct alignas(16) NearBody {
  std::uint32_t sphere = 0, body = 0;
  std::uint32_t first = 0, count = 0;
};

// Force of one body's walls on one sphere.
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
  // Only where each pair is evaluated once:
  std::uint32_t* mirror_start = nullptr;  // begin of each sphere's range in `mirror` (n + 1)
  std::uint32_t* mirror = nullptr;        // pair entries in which a sphere is the other one (pair entries)

  float* wall_slack = nullptr;        // per wall entry: no contact before the two have approached by this [m]
  NearBody* near = nullptr;           // ordered by sphere (window->near)
  std::uint32_t spring_capacity = 0;  // the largest number for laws without springs
  std::uint32_t pair_capacity = 0, wall_capacity = 0, near_capacity = 0;
};

}  // namespace tandem::dem
