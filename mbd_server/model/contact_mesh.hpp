// The surface of a body or of the ground as triangles: faces, edges and corners with their neighbours, and a
// tree of bounding boxes that finds what is near. The solid is behind the faces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"
#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

class ContactMesh {
 public:
  // Codes of features have 24 bits for an edge; and the tree stays small.
  static constexpr std::size_t most_triangles = 1 << 20;
  // An edge bends by less: its faces are one plane [rad].
  static constexpr double flat = 1e-4;
  // An edge bends by at most this angle: its faces are parts of one smooth surface, as for particles [rad].
  static constexpr double smooth = 25 * 3.14159265358979323846 / 180;

  enum class Bend : std::uint8_t { flat, convex, concave, border };
  struct Edge {
    int from = 0, to = 0;
    std::array<int, 2> faces{none, none};  // the second: none at a border
    Bend bend = Bend::border;
    bool smooth = false;
  };
  struct Face {
    std::array<int, 3> corners{};
    std::array<int, 3> edges{};  // from corner i to corner i + 1
    Vector3d normal = Vector3d::Zero();
    double thickness =
        0;  // half of the distance to the other side, behind the middle; inf: there is none [m]
  };

  // Corners in the frame of the link [m]; corners at the same place are one. `in_file`: the same corners as
  // the file has them, for messages. Throws Error{scene} at `path` where a triangle has no area, an edge
  // belongs to more than two triangles, two neighbours wind in opposite directions, a closed surface winds
  // inward, or there are too many triangles.
  ContactMesh(const std::vector<Vector3d>& vertices, const std::vector<Vector3d>& in_file,
              const std::vector<std::array<std::uint32_t, 3>>& triangles, const std::string& path);

  const std::vector<Vector3d>& points() const { return points_; }
  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const Face& face(int i) const { return faces_[static_cast<std::size_t>(i)]; }
  const Edge& edge(int i) const { return edges_[static_cast<std::size_t>(i)]; }
  const Vector3d& point(int i) const { return points_[static_cast<std::size_t>(i)]; }
  const Vector3d& on_face(int f) const { return point(face(f).corners[0]); }
  Vector3d middle(int f) const;
  // Edges at a corner.
  std::span<const int> edges_at(int corner) const;
  // Whether a corner of the surface sticks out: its edges are convex or flat, and not all along one line.
  bool sticks_out(int corner) const { return sticks_out_[static_cast<std::size_t>(corner)]; }
  bool closed() const { return closed_; }
  // Sphere about the middle of all corners.
  const Vector3d& centre() const { return centre_; }
  double bound() const { return bound_; }

  // Faces whose bounding boxes intersect the box, in ascending order.
  void near(const Vector3d& low, const Vector3d& high, std::vector<int>& faces) const;
  // Whether a closed surface encloses the point.
  bool encloses(const Vector3d& p) const;
  // Distance from a point to the surface [m], and the nearest face. Takes time in proportion to the faces.
  std::pair<double, int> distance(const Vector3d& p) const;
  // A face that a ray meets at `distance`, in units of the length of `along`. An edge belongs to both of its
  // faces.
  struct Crossing {
    double distance = 0;
    int face = none;
  };
  // The nearest first.
  void meet(const Vector3d& from, const Vector3d& along, std::vector<Crossing>& crossings) const;

 private:
  struct Node {
    Vector3d low, high;
    int first = 0, count = 0;  // faces in order_; count 0: children
    int left = none, right = none;
  };
  void weld(const std::vector<Vector3d>& vertices, const std::vector<Vector3d>& in_file,
            const std::vector<std::array<std::uint32_t, 3>>& triangles, const std::string& path);
  void join(const std::vector<Vector3d>& in_file, const std::string& path);
  void find_corners();
  int build(int first, int count);
  void measure_thickness();
  // Calls hit(distance, face) for faces that the ray meets.
  template <class Hit>
  void cast(const Vector3d& from, const Vector3d& along, const Hit& hit) const;

  std::vector<Vector3d> points_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  std::vector<int> at_corner_, first_at_corner_;  // edges, and where those of a corner begin
  std::vector<bool> sticks_out_;
  bool closed_ = true;
  Vector3d centre_ = Vector3d::Zero();
  double bound_ = 0;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace tandem::mbd
