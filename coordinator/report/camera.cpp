#include "coordinator/report/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem::launch {
Vec3d upwards(const scene::Scene& scene) {
  return norm2(scene.gravity) > 0 ? normalized(-scene.gravity) : Vec3d{0, 0, 1};
}

void Extents::Interval::add(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

Extents::Extents(Vec3d up) : up_(up) {
  // The world's axes where gravity is along one of them.
  const Vec3d across = std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  across_ = normalized(across - dot(across, up) * up);
  away_ = cross(up, across_);
}

void Extents::add(Vec3d p, double radius) {
  x_.add(dot(p, across_));
  y_.add(dot(p, away_));
  z_.add(dot(p, up_));
  lowest_ = std::min(lowest_, dot(p, up_) - radius);
}

double Extents::size() const {
  return std::hypot(x_.length(), y_.length(), z_.length());
}

double Extents::distance(Vec3d p) const {
  const auto beyond = [](const Interval& interval, double value) {
    return std::max({interval.low - value, value - interval.high, 0.0});
  };
  return std::hypot(beyond(x_, dot(p, across_)), beyond(y_, dot(p, away_)), beyond(z_, dot(p, up_)));
}

void Extents::add(const Frame& frame) {
  for (const Surface& surface : frame.surfaces)
    for (const Vec3d& vertex : surface.mesh.vertices) add(vertex);
  for (std::size_t i = 0; i < frame.radius.size(); ++i) add(frame.centre(i), frame.radius[i]);
}

scene::Camera Extents::camera(double aspect) const {
  Interval x = x_, y = y_;
  const Interval z = z_;
  Vec3d across = across_, away = away_;
  const Vec3d up = up_;
  if (y.length() > x.length()) {  // rotated by 90 degrees to show the broad side
    std::swap(x, y);
    std::swap(across, away);
    away = -away;
    std::swap(y.low, y.high);
    y = {-y.low, -y.high};
  }

  scene::Camera camera;
  camera.up = up;
  camera.target = x.middle() * across + y.middle() * away + z.middle() * up;
  const Vec3d view = normalized(away - 0.45 * across - 0.38 * up);  // from the eye to the target
  const Vec3d right = normalized(cross(view, up)), top = cross(right, view);

  // The nearest eye point from which all eight corners of the box are visible.
  const double slope = std::tan(0.5 * camera.field_of_view * std::numbers::pi / 180);
  double distance = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p = (corner & 1 ? 0.5 : -0.5) * x.length() * across +
                    (corner & 2 ? 0.5 : -0.5) * y.length() * away +
                    (corner & 4 ? 0.5 : -0.5) * z.length() * up;
    distance = std::max({distance, std::abs(dot(p, right)) / slope - dot(p, view),
                         std::abs(dot(p, top)) / (slope / aspect) - dot(p, view)});
  }
  camera.eye = camera.target - 1.08 * distance * view;
  return camera;
}

scene::Camera automatic_camera(const Frame& frame, Vec3d up, double aspect) {
  Extents extents(up);
  extents.add(frame);
  return extents.camera(aspect);
}

}  // namespace tandem::launch
