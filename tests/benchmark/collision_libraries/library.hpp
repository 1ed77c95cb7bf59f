// What the comparison asks of a collision library.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace collision_libraries {

using Eigen::Isometry3d;
using Eigen::Vector3d;

struct Point {
  Vector3d p, n;     // n: from b to a, whatever the library's own direction is
  double depth = 0;  // negative: a distance
};

struct Shape {
  enum Kind { sphere, box, capsule, cylinder, plane, hull, mesh, height_field } kind = sphere;
  double radius = 0, height = 0;  // [m]; of the capsule: of its cylinder; axis z
  Vector3d size = Vector3d::Zero();
  std::vector<Vector3d> vertices{};             // hull, mesh
  std::vector<std::array<int, 3>> triangles{};  // hull, mesh: outward
  int samples = 0;                              // height field: along each side of a square of `size`
};

class Geometry {
 public:
  virtual ~Geometry() = default;
};

class Library {
 public:
  virtual ~Library() = default;
  virtual std::string name() const = 0;
  // Null where the library has no such shape.
  virtual std::unique_ptr<Geometry> make(const Shape& shape) = 0;
  virtual std::vector<Point> collide(Geometry& a, const Isometry3d& X_a, Geometry& b,
                                     const Isometry3d& X_b) = 0;
  // Of separated shapes; none where the library does not know it.
  virtual std::optional<double> distance(Geometry& a, const Isometry3d& X_a, Geometry& b,
                                         const Isometry3d& X_b) = 0;
};

std::unique_ptr<Library> make_bullet();
std::unique_ptr<Library> make_ode();
std::unique_ptr<Library> make_fcl();

}  // namespace collision_libraries
