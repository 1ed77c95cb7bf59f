// Writes objects in POV-Ray's language. POV-Ray's tolerances are absolute: in its scene the origin is the
// target of the camera, and the eye is always at the same distance from it.
#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "coordinator/report/element_rods.hpp"
#include "coordinator/report/patches.hpp"
#include "coordinator/report/pov_scene.hpp"
#include "coordinator/report/regions.hpp"

namespace tandem::launch {

inline constexpr double pov_eye_distance = 10;

class PovWriter {
 public:
  PovWriter(std::ostream& out, const View& view);

  double size() const { return size_; }  // of the picture [m]
  Vec3d local(Vec3d p) const { return scale_ * (p - view_.camera.target); }

  // Camera, lights, sky and the ground of the picture, on which nothing casts a shadow.
  void stage();
  void spheres(const Frame& frame);
  void liquid(const LiquidSurface& surface);
  // Each patch as transparent as what it hides asks for. A surface with a transparent patch is a container,
  // which casts no shadow into itself; nor do fixed surfaces.
  void surface(const Surface& surface, const std::vector<Patch>& patches, Vec3d tint);
  // What bodies roll on is solid from its front, and clear from behind.
  void ground(const Surface& surface, std::vector<Patch> patches, Vec3d tint);
  void elements(const std::vector<Rod>& rods);
  void arrows(const std::vector<Arrow>& arrows);
  // A line in its own light.
  void rod(Vec3d a, Vec3d b, double radius, Vec3d colour);

 private:
  std::string point(Vec3d p) const;
  double length(double l) const { return scale_ * l; }
  std::size_t shade_of(double value) const;
  void faces(const Surface& surface, const std::vector<std::array<std::uint32_t, 3>>& triangles, Vec3d tint,
             double clearness, bool shadow);
  void edges(const Surface& surface, Vec3d tint);
  std::string nearer();

  std::ostream& out_;
  const View& view_;
  double size_, scale_;
  int layer_ = 0;  // of the faces so far
};

}  // namespace tandem::launch
