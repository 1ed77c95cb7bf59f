// The camera of the picture.
#pragma once

#include "common/scene/model.hpp"
#include "coordinator/report/frame.hpp"

namespace tandem::launch {

// Against gravity; z where there is no gravity [-].
Vec3d upwards(const scene::Scene& scene);

// The space that one or more frames take, along the axes of the picture.
class Extents {
 public:
  explicit Extents(Vec3d up);
  void add(const Frame& frame);
  void add(Vec3d point, double radius = 0);
  bool empty() const { return x_.low > x_.high; }
  double size() const;  // of the diagonal [m]
  // Distance of a point from the space; 0 inside [m].
  double distance(Vec3d point) const;
  double lowest() const { return lowest_; }  // of surfaces and spheres, along `up` [m]
  // A view from the front, a little from the right and from above, onto the broad side of the space. `aspect`
  // = width / height of the picture.
  scene::Camera camera(double aspect) const;

 private:
  struct Interval {
    double low = 1e300, high = -1e300;
    void add(double value);
    double middle() const { return 0.5 * (low + high); }
    double length() const { return high - low; }
  };

  Vec3d up_, across_, away_;
  Interval x_, y_, z_;  // of vertices and centres of spheres [m]
  double lowest_ = 1e300;
};

scene::Camera automatic_camera(const Frame& frame, Vec3d up, double aspect);

}  // namespace tandem::launch
