// The part of the world that a packing fills: its region, clipped at walls and solids.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/scene/model.hpp"
#include "particles/base/thread_pool.hpp"
#include "particles/geometry/surface.hpp"
#include "particles/io/plan_outline.hpp"
#include "particles/io/room_meshes.hpp"
#include "particles/io/vertical_crossings.hpp"

namespace tandem::particles {

// All positions are in the gravity frame.
class Room {
 public:
  // `surface`: the walls of the scene, with a reach of at least the largest radius. Error{scene} where the
  // region is no container.
  Room(const scene::Scene& scene, std::size_t group, const Surface& surface,
       const std::vector<NamedMesh>& meshes, ThreadPool& pool);

  const GravityFrame& frame() const { return frame_; }
  Vec3d low() const { return low_; }
  Vec3d high() const { return high_; }  // its z is at most the level
  // Of the part below a height [m3]. Exact in z, by columns over the plan.
  double volume_below(double height) const;
  double volume() const { return volume_below(high_.z); }
  // The height below which the room has this volume.
  double height_of(double volume) const;
  // Spheres stay below this height [m].
  void limit(double height) { high_.z = height; }

  // Whether a centre is in the region and in no solid.
  bool holds(Vec3d p) const;
  // Whether a sphere with its centre in the room overlaps a wall or leaves the region.
  bool overlaps(Vec3d p, double radius) const;
  // Moves the sphere out of the walls and into the region.
  Vec3d moved_inside(Vec3d p, double radius) const;

  const std::string& where() const { return where_; }

 private:
  struct Interval {
    double low = 0, high = 0;
  };
  void find_solids(const scene::Scene& scene, const std::vector<NamedMesh>& meshes,
                   std::string_view container);
  void make_columns(ThreadPool& pool);
  bool is_around_region(const VerticalCrossings& solid) const;
  bool in_region(Vec3d p) const;
  Vec3d into_region(Vec3d p, double radius) const;
  Vec3d moved_once(Vec3d p, double radius, bool& again) const;
  double ground(double x, double y) const;  // the highest point of the wall below a bed
  double top(double x, double y) const;     // of the bed above it
  template <class F>
  void for_walls(Vec3d world, double radius, F f) const;

  const Surface& surface_;
  decltype(scene::PackingFill::region) region_;
  std::string where_;
  GravityFrame frame_;
  std::vector<Pose> poses_;                    // of the bodies of the surface
  std::optional<VerticalCrossings> boundary_;  // of the region; of the wall below it for a bed
  PlanOutline outline_;                        // of the wall below a bed
  std::vector<VerticalCrossings> solids_;
  std::vector<scene::PlaneShape> planes_;  // in the gravity frame
  std::vector<scene::PlaneShape> faces_;   // of the room between walls, with normals outwards
  Vec3d low_, high_;
  std::vector<Interval> intervals_;  // of the columns that are in the room
  double column_area_ = 0;           // [m2]
};

}  // namespace tandem::particles
