// Contacts of one sphere with the walls of one body. The code uses only + - * / sqrt and comparisons, so that
// every back end gets the same bits. docs/wall_contact.md explains the merging rule and its limits.
#pragma once

#include "particles/base/uninitialised.hpp"
#include "particles/geometry/touch_facet.hpp"

namespace tandem::particles {

inline constexpr int max_wall_contacts = 8;       // of one sphere with one body
inline constexpr int wall_contact_overflow = -1;  // returned when `capacity` is too small

// A wall point at most this far (times the radius) in front of the tangent plane of a deeper contact still
// belongs to it: coplanar parts of different meshes have the rounding errors of their files (single precision
// in STL).
inline constexpr double tangent_tolerance = 1e-5;
// Closest points at most this far apart (times the radius) are one point: contacts with an edge that two
// patches share.
inline constexpr double coincidence_tolerance = 1e-9;

// Order of depth; equal depths are ordered by facet index.
TANDEM_HD inline bool deeper(const WallContact& k, const WallContact& than) {
  return k.gap < than.gap || (!(than.gap < k.gap) && k.facet < than.facet);
}

// Is the closest point of k at or behind the tangent plane of j? The surface of j then already represents it.
TANDEM_HD inline bool covered(const WallContact& k, const WallContact& j, double radius) {
  return dot(k.point - j.point, j.normal) <= tangent_tolerance * radius;
}

// The contacts of a sphere with single facets, each computed once and stored.
struct StoredContacts {
  static constexpr int capacity = 24;
  WallContact* list = nullptr;  // (capacity)
  int count = 0;

  TANDEM_HD std::uint32_t patch(int i) const { return list[i].patch; }
  TANDEM_HD std::uint32_t facet(int i) const { return list[i].facet; }
  TANDEM_HD bool get(int i, WallContact& k) const {
    k = list[i];
    return true;
  }
};

// The same for more contacts than that, on a mesh much finer than the sphere: each is recomputed at every
// access.
template <class Near>
struct RecomputedContacts {
  Vec3d centre_B;
  double radius;
  const Near& near;
  int count;
  const Facet* facets;

  TANDEM_HD std::uint32_t patch(int i) const { return facets[near[i]].patch; }
  TANDEM_HD std::uint32_t facet(int i) const { return near[i]; }
  TANDEM_HD bool get(int i, WallContact& k) const {
    return touch_facet(facets, near[i], centre_B, radius, k);
  }
};

// Does a facet of `patch` touch the sphere at the point of contact j?
template <class FacetContacts>
TANDEM_HD bool touches_at(std::uint32_t patch, const WallContact& j, double radius,
                          const FacetContacts& facet_contacts) {
  const double tolerance = coincidence_tolerance * radius;
  WallContact k;
  for (int i = 0; i < facet_contacts.count; ++i) {
    if (facet_contacts.patch(i) != patch || !facet_contacts.get(i, k)) continue;
    if (norm2(k.point - j.point) <= tolerance * tolerance) return true;
  }
  return false;
}

// On an edge or corner the patches that join there have equal depths up to rounding. The lowest of them names
// the contact, so that the name, and with it the friction history, does not flicker. A patch that touches the
// sphere in two of its contacts names neither.
template <class FacetContacts>
TANDEM_HD void name_contacts(double radius, const FacetContacts& facet_contacts, const Facet* facets,
                             WallContact* out, int kept) {
  WallContact k;
  for (int j = 0; j < kept; ++j) {
    const std::uint32_t own = facets[out[j].facet].patch;
    std::uint32_t name = own, other = own;
    double other_gap = 0;
    bool own_shared = false;
    for (int other_j = 0; other_j < kept && !own_shared; ++other_j) {
      own_shared = other_j != j && touches_at(own, out[other_j], radius, facet_contacts);
    }
    for (int i = 0; i < facet_contacts.count; ++i) {
      const std::uint32_t patch = facet_contacts.patch(i);
      bool usable = patch != own;
      for (int other_j = 0; other_j < kept && usable; ++other_j)
        usable = patch != facets[out[other_j].facet].patch;
      if (!usable || !facet_contacts.get(i, k) || !covered(k, out[j], radius)) continue;
      if (k.gap < other_gap) {
        other = patch;
        other_gap = k.gap;
      }
      const double tolerance = coincidence_tolerance * radius;
      if (norm2(k.point - out[j].point) > tolerance * tolerance) continue;
      if (patch > name && !(own_shared && name == own)) continue;
      for (int other_j = 0; other_j < kept && usable; ++other_j) {
        usable = other_j == j || !touches_at(patch, out[other_j], radius, facet_contacts);
      }
      if (usable) name = patch;
    }
    out[j].patch = name;
    out[j].neighbour = name == own ? other : own;
  }
}

// Selection by passes in order of depth; a sphere in contact with one patch needs one pass.
template <class FacetContacts>
TANDEM_HD int select_contacts(double radius, const FacetContacts& facet_contacts, const Facet* facets,
                              WallContact* out, int capacity) {
  int kept = 0;
  bool several_patches = false;
  WallContact last, k;                   // `last`: the facet chosen by the previous pass
  std::uint32_t rejected = 0xffffffffu;  // patch whose deepest facet is covered
  for (bool first = true;; first = false) {
    WallContact best;
    bool found = false;
    for (int i = 0; i < facet_contacts.count; ++i) {
      if (!facet_contacts.get(i, k)) continue;
      if (first) {
        several_patches = several_patches || (found && k.patch != best.patch);
      } else {
        bool skip = k.patch == rejected || !deeper(last, k);
        for (int j = 0; j < kept && !skip; ++j) {
          skip = k.patch == facets[out[j].facet].patch || covered(k, out[j], radius);
        }
        if (skip) continue;
      }
      if (!found || deeper(k, best)) best = k;
      found = true;
    }
    if (!found) break;
    last = best;
    // Only its deepest facet represents a patch: otherwise the distant triangles of a finely meshed ramp
    // would add contacts.
    bool deepest = true;
    for (int i = 0; i < facet_contacts.count && !first && deepest; ++i) {
      if (facet_contacts.patch(i) != best.patch || facet_contacts.facet(i) == best.facet) continue;
      deepest = !(facet_contacts.get(i, k) && deeper(k, best));
    }
    if (deepest) {
      if (kept == capacity) return wall_contact_overflow;
      out[kept++] = best;
    } else {
      rejected = best.patch;
    }
    if (!several_patches) return kept;
  }
  if (several_patches) name_contacts(radius, facet_contacts, facets, out, kept);
  return kept;
}

// Is the sphere in contact with facet near[i], and how? Lists that store bounds of the distance have an
// overload.
template <class Near>
TANDEM_HD bool touches_facet(const Near& near, int i, Vec3d centre_B, double radius, const Facet* facets,
                             WallContact& k) {
  return touch_facet(facets, near[i], centre_B, radius, k);
}

// Memory for the contacts of one sphere with one body.
struct WallContactSpace {
  UninitialisedArray<WallContact, StoredContacts::capacity> facet_contacts;
  UninitialisedArray<WallContact, max_wall_contacts> contacts;
  std::uint32_t history[max_wall_contacts];  // list entry that holds each contact's history
};

// All contacts (gap < 0) of the sphere with the facets `near` of one body, deepest first: the deepest facet
// of each patch; of these, in order of depth, those that no deeper one covers. Coplanar tessellations, convex
// edges and corners therefore yield one contact, concave corners one for each side. `near` has
// operator[](int) -> facet index, ascending, `count` of them. Writes the contacts to `space` and returns
// their number, or wall_contact_overflow when there are more than `capacity`.
template <class Near>
TANDEM_HD int collect_wall_contacts(Vec3d centre_B, double radius, const Near& near, int count,
                                    const Facet* facets, WallContactSpace& space,
                                    int capacity = max_wall_contacts) {
  StoredContacts found{space.facet_contacts.data(), 0};
  for (int i = 0; i < count; ++i) {
    WallContact k;
    if (!touches_facet(near, i, centre_B, radius, facets, k)) continue;
    if (found.count < StoredContacts::capacity) found.list[found.count] = k;
    ++found.count;
  }
  if (found.count == 0) return 0;
  if (found.count <= StoredContacts::capacity)
    return select_contacts(radius, found, facets, space.contacts.data(), capacity);
  return select_contacts(radius, RecomputedContacts<Near>{centre_B, radius, near, count, facets}, facets,
                         space.contacts.data(), capacity);
}

inline constexpr int needs_general_rule = -2;

struct FewWallContacts {
  WallContact a, b, c;
};

TANDEM_HD inline void order_by_depth(WallContact& first, WallContact& second) {
  if (!deeper(second, first)) return;
  const WallContact deepest = second;
  second = first;
  first = deepest;
}

// The same for a sphere in contact with at most three patches, without a list. It covers the cases of the
// general rule in which the deepest contact covers all others, as on convex edges and corners, or none covers
// another, as in concave ones. Returns the number of contacts, stored in `few` deepest first, or
// needs_general_rule: call collect_wall_contacts().
template <class Near>
TANDEM_HD int collect_few_wall_contacts(Vec3d centre_B, double radius, const Near& near, int count,
                                        const Facet* facets, FewWallContacts& few) {
  WallContact &a = few.a, &b = few.b, &c = few.c;
  int patches = 0;  // number of patches whose deepest contacts are in a, b, c
  for (int i = 0; i < count; ++i) {
    WallContact k;
    if (!touches_facet(near, i, centre_B, radius, facets, k)) continue;
    if (patches > 0 && k.patch == a.patch) {
      if (deeper(k, a)) a = k;
    } else if (patches > 1 && k.patch == b.patch) {
      if (deeper(k, b)) b = k;
    } else if (patches > 2 && k.patch == c.patch) {
      if (deeper(k, c)) c = k;
    } else if (patches == 3) {
      return needs_general_rule;
    } else {
      (patches == 0 ? a : patches == 1 ? b : c) = k;
      ++patches;
    }
  }
  if (patches < 2) return patches;
  order_by_depth(a, b);
  if (patches == 3) {
    order_by_depth(b, c);
    order_by_depth(a, b);
  }
  const bool b_covered = covered(b, a, radius), c_covered = patches == 3 && covered(c, a, radius);
  if (!b_covered && !c_covered) return patches == 2 || !covered(c, b, radius) ? patches : needs_general_rule;
  if (!b_covered || (patches == 3 && !c_covered)) return needs_general_rule;

  const double tolerance = coincidence_tolerance * radius;
  const std::uint32_t own = a.patch;
  const auto name = [&](const WallContact& k) {
    if (k.patch < a.patch && norm2(k.point - a.point) <= tolerance * tolerance) a.patch = k.patch;
  };
  name(b);
  if (patches == 3) name(c);
  a.neighbour = a.patch == own ? b.patch : own;
  return 1;
}

}  // namespace tandem::particles
