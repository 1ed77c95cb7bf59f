// Everything that the functors of a run read and write, as plain pointers that are valid on the processor
// that runs them. [2]: double buffered; Progress::state_side says which half is
// current.
#pragma once

#include <cstdint>

#include "dem_server/laws/history.hpp"
#include "dem_server/state/control.hpp"
#include "dem_server/geometry/path.hpp"
#include "dem_server/geometry/surface.hpp"
#include "dem_server/contact/parameters.hpp"
#include "dem_server/state/particles.hpp"
#include "dem_server/grid/size_levels.hpp"

namespace tandem::dem {

// An entry of the pair lists: the other sphere and, where the law has friction, whether the two touched in
// the last micro step, that is: whether spring and turn of the entry mean anything.
struct Neighbour {
  static constexpr std::uint32_t touched_bit = 1u << 31;  // beyond all slots
  std::uint32_t word = 0;

  TANDEM_HD static Neighbour of(std::uint32_t slot, bool touched) {
    return {slot | (touched ? touched_bit : 0)};
  }
  TANDEM_HD std::uint32_t slot() const { return word & ~touched_bit; }
  TANDEM_HD bool touched() const { return word >= touched_bit; }
};

// Entries of sphere i are [start[i], start[i+1]). Where pairs are evaluated once, a pair of spheres has one
// entry, in the list of the one in the lower slot; else each of the two has one.
template <class Real>
struct PairList {
  std::uint32_t* start = nullptr;  // (n + 1)
  Neighbour* entry = nullptr;
  // Elastic tangential displacement relative to the other sphere; absent for laws without friction [m]
  Vec3<Real>* spring = nullptr;  // there is room behind them, see carried_contact()
  Turn<Real>* turn = nullptr;    // of each entry, where the scene has rolling or twisting
  Image* image = nullptr;        // of the other sphere, where the domain is periodic
};

// The same of the facets near spheres. Entries of a sphere and a body are those that a NearBody says.
template <class Real>
struct WallList {
  std::uint32_t* entry = nullptr;    // facet
  History<Real>* history = nullptr;  // absent for laws without friction
  Turn<Real>* turn = nullptr;        // where the scene has rolling or twisting
};

// A contact that was touched in the last micro step, which a rebuild carries over from the old lists to the
// new ones. That of two spheres is kept by the one in the lower old slot. It is as large as a Place, a Drift
// and a Spin, in whose memory it may lie.
template <class Real>
struct alignas(4 * sizeof(Real)) CarriedContact {
  std::uint32_t with = 0;  // the other sphere's old slot, or with_wall and a patch
  Vec3<Real> spring;       // see History [m]
};
inline constexpr std::uint32_t with_wall = 1u << 31;  // beyond all slots and patches

inline constexpr std::uint32_t carried_beside = 3;  // contacts for each sphere, in its Place, Drift and Spin

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
  std::uint32_t owner = 0;  // slot
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
  std::uint32_t sphere = 0, slot = 0;
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

// Entries of new lists, and what is carried over to them from the sphere that had the same slot before.
struct ListCounts {
  std::uint32_t pairs = 0, mirrors = 0, walls = 0;
  std::uint32_t near = 0;  // bodies
  std::uint32_t carried = 0;

  TANDEM_HD friend ListCounts operator+(const ListCounts& a, const ListCounts& b) {
    return {a.pairs + b.pairs, a.mirrors + b.mirrors, a.walls + b.walls, a.near + b.near,
            a.carried + b.carried};
  }
};

template <class Real>
struct View {
  std::uint32_t n = 0;  // slots for spheres
  Control* control = nullptr;
  bool follows = false;         // the domain is displaced with a body
  Parameters<Real> parameters;  // by value: a kernel's arguments need no load and no reload after a store

  // By Progress::state_side.
  Place<Real>* place[2]{};               // (n)
  Drift<Real>* drift[2]{};               // (n)
  Spin<Real>* spin[2]{};                 // (n); absent for laws without friction
  Remainder<Real>* remainder = nullptr;  // (n); absent where there is none
  // As numbered at the start; of no meaning where parked. Absent where Spin has it (n)
  std::uint32_t* id = nullptr;

  PairList<Real> pairs;
  WallList<Real> walls;
  // Where pairs are evaluated once:
  std::uint32_t* mirror_start = nullptr;  // of each sphere in `mirror` (n + 1)
  std::uint32_t* mirror = nullptr;        // entries in which a sphere is the other one (pair entries)
  ClosePairs<Real> close;

  float* wall_slack = nullptr;            // of each wall entry: nearer by less, and it does not touch [m]
  NearBody* near = nullptr;               // in the order of spheres (control->near)
  WallForce<Real>* wall_force = nullptr;  // of the present step (control->near)
  std::uint32_t spring_capacity = 0;      // as large as can be where there are none
  std::uint32_t pair_capacity = 0, wall_capacity = 0, near_capacity = 0, turn_capacity = 0;

  // Used while lists are built.
  CellGrid grid[2];                     // of the finest level, see SizeLevels
  std::uint32_t* source = nullptr;      // slot before sorting (n)
  std::uint32_t* cell_start = nullptr;  // first slot of each cell, parked ones last
  // Levels of sizes, the finest one first.
  std::uint32_t levels = 1;
  typename LengthUnit<Real>::Count largest_of_finest{};  // radius, at most
  const CoarseLevel* coarse = nullptr;                   // (levels - 1)
  std::uint32_t* coarse_start = nullptr;                 // of each cell of a coarse level, in `coarse_slot`
  std::uint32_t* coarse_slot = nullptr;  // spheres by such cells, then those of the finest (n)
  ListCounts* count = nullptr;           // of each sphere, then of all below it (n + 1)
  Turn<Real>* carried_turn = nullptr;    // of all carried_contact(), where lists have turns (turn_capacity)

  const PairExtras<Real>* extras = nullptr;  // (max_materials^2), for the generic variant

  // Walls.
  std::uint32_t slots = 0;  // bodies with walls, ground included
  const Facet* facets = nullptr;
  const Patch* patches = nullptr;
  const FacetGrid* facet_grids = nullptr;
  const std::uint32_t *facet_cell_start = nullptr, *facet_cell_entry = nullptr;
  const BodyPose* pose = nullptr;  // (steps x slots)
  std::int64_t* load = nullptr;    // (steps x (slots + 1) x 6) force, torque in quanta; see below
  std::int64_t* books = nullptr;   // (book_count) see engine/account.hpp
  // Of each step's loads, row `slots` books spheres that left the domain: momentum as force; as torque x,
  // mass times micro steps that it stayed in this window.

  TANDEM_HD const CellGrid& cells() const { return grid[control->skin > control->skins.usual ? 1 : 0]; }
  // x in a domain at its first place [m].
  TANDEM_HD Vec3d place_in_domain(Vec3d x) const { return follows ? x - control->domain_shift : x; }
  TANDEM_HD bool inside_domain(typename CentreUnit<Real>::Centre x) const {
    if (follows) x -= parameters.centres.of(control->domain_shift);
    return parameters.inside_domain(x);
  }

  // Entries of `near` that are sphere i's, to which `label` label.
  TANDEM_HD Range near_of(std::uint32_t i, const Label& label) const {
    Range of{label.near_first(), label.near_first() + label.near_count()};
    if (label.near_count() == Label::counted)
      while (of.end < control->near && near[of.end].sphere == i) ++of.end;
    return of;
  }

  TANDEM_HD Remainder<Real> remainder_of(std::uint32_t i) const {
    if constexpr (has_remainder<Real>)
      return remainder[i];
    else
      return {};
  }
  // Of sphere i in full, as it is on that side of the state: the current one but for rebuilds.
  TANDEM_HD Vec3d centre(std::uint32_t side, std::uint32_t i) const {
    return parameters.centre(place[side][i], remainder_of(i));  // [m]
  }
  TANDEM_HD Vec3d velocity(std::uint32_t side, std::uint32_t i) const {
    return velocity_of(drift[side][i], remainder_of(i));  // [m/s]
  }
};

}  // namespace tandem::dem
