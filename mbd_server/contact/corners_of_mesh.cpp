// Corners of a mesh on the faces of a box or hull, or on the side of a capsule.
#include <algorithm>
#include <cmath>

#include "mbd_server/contact/features.hpp"
#include "mbd_server/contact/mesh_search.hpp"

namespace tandem::mbd {
namespace {

class CornersOfMesh : MeshSearch {
 public:
  explicit CornersOfMesh(const MeshSearch& search) : MeshSearch(search) {}

  void add() {
    Vector3d low = Vector3d::Constant(HUGE_VAL), high = -low;
    for (const Vector3d& x : a_.points) low = low.cwiseMin(local(x)), high = high.cwiseMax(local(x));
    const Vector3d margin = Vector3d::Constant(a_.radius + reach_);
    mesh_.near(low - margin, high + margin, near_);
    std::vector<int> corners;
    for (const int f : near_)
      for (const int c : mesh_.face(f).corners)
        if (mesh_.sticks_out(c)) corners.push_back(c);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (const int c : corners)
      if (a_.is_polytope())
        corner_on_face(c);
      else
        corner_on_rod(c);
  }

 private:
  int face_at(int corner) const { return mesh_.edge(mesh_.edges_at(corner)[0]).faces[0]; }

  void corner_on_face(int v) {
    const Vector3d c = mesh_.point(v), x = back(c);
    double best = -HUGE_VAL;
    std::size_t face = 0;
    for (std::size_t k = 0; k < a_.faces.size(); ++k) {
      const double s = a_.faces[k].normal.dot(x - a_.points[nth(a_.faces[k].corners[0])]);
      if (s > best && points_at(v, R_ * a_.faces[k].normal)) best = s, face = k;
    }
    if (best > reach_ || best < -2 * std::min(mesh_.face(face_at(v)).thickness, a_.thickness)) return;
    const ContactShape::Face& on = a_.faces[face];
    for (std::size_t i = 0; i < on.corners.size(); ++i) {
      const Vector3d &y = a_.points[nth(on.corners[i])],
                     &z = a_.points[nth(on.corners[(i + 1) % on.corners.size()])];
      if ((z - y).cross(on.normal).dot(x - y) > 0) return;
    }
    ContactFeature f;
    f.kind = ContactFeature::Kind::plane;
    f.a = index_b_, f.b = index_a_;
    f.code = code_of(Family::mesh_corner, 0, v);
    f.face = face_at(v);
    f.place_a = c;
    f.place_b = a_.points[nth(on.corners[0])];
    f.axis_b = on.normal;
    out_.push_back(f);
  }

  // Whether the edges at a corner of the mesh lead away from a face of that normal.
  bool points_at(int v, const Vector3d& normal) const {
    for (const int e : mesh_.edges_at(v)) {
      const ContactMesh::Edge& edge = mesh_.edge(e);
      const Vector3d d = mesh_.point(edge.from == v ? edge.to : edge.from) - mesh_.point(v);
      if (d.dot(normal) < -tilt_of_corner * d.norm()) return false;
    }
    return true;
  }

  void corner_on_rod(int v) {
    const Vector3d c = mesh_.point(v), p = local(a_.points[0]), d = local(a_.points[1]) - p;
    const double s = d.dot(c - p) / d.squaredNorm();
    if (s <= 0 || s >= 1) return;
    const Vector3d out = p + s * d - c;
    if (out.norm() - a_.radius > reach_) return;
    for (const int e : mesh_.edges_at(v)) {
      const ContactMesh::Edge& edge = mesh_.edge(e);
      const Vector3d along = mesh_.point(edge.from == v ? edge.to : edge.from) - c;
      if (out.dot(along) > tilt_of_edge * out.norm() * along.norm()) return;
    }
    ContactFeature f;
    f.kind = ContactFeature::Kind::line;
    f.a = index_b_, f.b = index_a_;
    f.place_b = a_.points[0], f.axis_b = a_.axis();
    f.code = code_of(Family::mesh_corner, 0, v);
    f.face = face_at(v);
    f.place_a = c;
    f.radius_b = a_.radius;
    out_.push_back(f);
  }
};

}  // namespace

void add_mesh_corners(const MeshSearch& search) {
  CornersOfMesh(search).add();
}

}  // namespace tandem::mbd
