// Surfaces of the ground that tyres roll on.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbd_server/model/contact_mesh.hpp"

namespace tandem::mbd {

// In the frame of the ground's link. A mesh, or a plane.
struct RoadSurface {
  std::string name;
  std::shared_ptr<const ContactMesh> mesh{};
  Vector3d point = Vector3d::Zero(), normal = Vector3d::UnitZ();  // of the plane [m], [-]
  int shape = none;                                               // of BodyContactModel
};

struct Road {
  // A face steeper than this against the direction upwards is a step: cosine of 45 degrees.
  static constexpr double least_cosine = 0.70710678118654752;

  std::vector<RoadSurface> surfaces;

  // The plane of the face that the ray from a point against `up` meets first.
  struct Place {
    const RoadSurface* surface = nullptr;
    Vector3d point = Vector3d::Zero(), normal = Vector3d::Zero();
    bool from_behind = false;  // the point is inside the road
  };
  std::optional<Place> below(const Vector3d& from, const Vector3d& up) const;
  // A surface with a step between two points, or null.
  const RoadSurface* step_between(const Vector3d& a, const Vector3d& b, const Vector3d& up) const;
};

}  // namespace tandem::mbd
