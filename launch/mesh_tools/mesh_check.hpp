// What is wrong with a triangle mesh.
#pragma once

#include <string>

#include "coordinator/mesh_import/mesh_facts.hpp"

namespace tandem::launch {

struct MeshFaults {
  MeshFacts facts;
  std::size_t without_area = 0;  // triangles
  std::size_t duplicates = 0;    // triangles that have the corners of another one
  std::size_t slivers = 0;       // triangles whose height is less than 1/1000 of their longest edge
  // Pairs of triangles that pass through each other, and share no corner; those that only touch are none.
  // Counted up to `most_intersections`.
  std::size_t intersections = 0;
  Vec3d intersection_at;  // [m]
  // Pairs of triangles of one plane that have an area in common, and are no duplicates; counted alike.
  std::size_t overlaps = 0;
  Vec3d overlap_at;           // [m]
  std::string why_not_solid;  // empty: it encloses a volume

  bool is_inside_out() const { return facts.volume && *facts.volume < 0; }
  bool is_sound_but_open() const {
    return without_area == 0 && duplicates == 0 && intersections == 0 && overlaps == 0 &&
           facts.unjoined_edges == 0 && facts.non_manifold_edges == 0 && facts.inverted_edges == 0 &&
           !is_inside_out() && why_not_solid.empty();
  }
  bool is_sound() const { return facts.open_edges == 0 && is_sound_but_open(); }
};
inline constexpr std::size_t most_intersections = 1000;

MeshFaults faults_of(const TriangleMesh& mesh);

// In lines, with what to do.
std::string report_of(const MeshFaults& faults, const std::string& file);

}  // namespace tandem::launch
