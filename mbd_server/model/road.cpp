#include "mbd_server/model/road.hpp"

#include <cmath>

namespace tandem::mbd {

std::optional<Road::Place> Road::below(const Vector3d& from, const Vector3d& up) const {
  std::optional<Place> nearest;
  double distance = HUGE_VAL;
  std::vector<ContactMesh::Crossing> crossings;
  for (const RoadSurface& s : surfaces) {
    if (s.mesh) {
      s.mesh->meet(from, -up, crossings);
      if (crossings.empty() || crossings.front().distance >= distance) continue;
      distance = crossings.front().distance;
      const int f = crossings.front().face;
      const Vector3d& n = s.mesh->face(f).normal;
      nearest = Place{&s, s.mesh->on_face(f), n, n.dot(up) < 0};
      continue;
    }
    const double height = s.normal.dot(from - s.point), cosine = s.normal.dot(up);
    if (height < 0) return Place{&s, s.point, s.normal, true};
    if (!(cosine > 0) || height / cosine >= distance) continue;
    distance = height / cosine;
    nearest = Place{&s, s.point, s.normal, false};
  }
  return nearest;
}

const RoadSurface* Road::step_between(const Vector3d& a, const Vector3d& b, const Vector3d& up) const {
  constexpr double at_end = 1e-9;
  std::vector<ContactMesh::Crossing> crossings;
  for (const RoadSurface& s : surfaces) {
    if (!s.mesh) continue;
    s.mesh->meet(a, b - a, crossings);
    for (const ContactMesh::Crossing& c : crossings)
      if (c.distance < 1 - at_end && std::abs(s.mesh->face(c.face).normal.dot(up)) < least_cosine) return &s;
  }
  return nullptr;
}

}  // namespace tandem::mbd
