#include "mbd_server/contact/mesh_back.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/touch.hpp"

namespace tandem::mbd {
namespace {

struct Side {
  double distance = HUGE_VAL;         // to the nearest place of the surface [m]
  bool behind = false, open = false;  // of that place; whether it is on an open edge
};

// On which side of these faces p is, in the frame of the mesh.
Side side_of(const ContactMesh& mesh, const Vector3d& p, std::span<const int> faces) {
  Side nearest;
  const auto front = [&](int f) { return mesh.face(f).normal.dot(p - mesh.on_face(f)); };
  for (const int f : faces) {
    const ContactMesh::Face& face = mesh.face(f);
    if (is_above(mesh, f, p, 0)) {
      if (const double s = front(f); std::abs(s) < nearest.distance) nearest = {std::abs(s), s < 0, false};
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const ContactMesh::Edge& edge = mesh.edge(face.edges[k]);
      const Vector3d x = mesh.point(edge.from), d = mesh.point(edge.to) - x;
      const double along = std::clamp(d.dot(p - x) / d.squaredNorm(), 0., 1.),
                   distance = (p - x - along * d).norm();
      if (!(distance < nearest.distance)) continue;
      nearest.distance = distance;
      // The normals at the place, of all faces that meet there.
      Vector3d normals = Vector3d::Zero();
      nearest.open = false;
      const auto add = [&](const ContactMesh::Edge& e) {
        for (const int g : e.faces) {
          if (g == none)
            nearest.open = true;
          else
            normals += mesh.face(g).normal;
        }
      };
      if (along > 0 && along < 1)
        add(edge);
      else
        for (const int e : mesh.edges_at(along > 0 ? edge.to : edge.from)) add(mesh.edge(e));
      nearest.behind = normals.dot(p - x - along * d) < 0;
    }
  }
  return nearest;
}

}  // namespace

bool is_above(const ContactMesh& mesh, int f, const Vector3d& p, double eps) {
  const ContactMesh::Face& face = mesh.face(f);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d &x = mesh.point(face.corners[k]), &y = mesh.point(face.corners[(k + 1) % 3]);
    if ((y - x).cross(face.normal).normalized().dot(p - x) > eps) return false;
  }
  return true;
}

std::optional<ContactFeature> on_back(const Model& model, int a, int b, std::size_t i,
                                      const std::vector<LinkMotion>& links, std::span<const int> faces) {
  const ContactShape& shape = model.contact.shape(a);
  const ContactMesh& mesh = *model.contact.shape(b).mesh;
  if (mesh.closed()) return {};
  const auto local = [&](const Vector3d& p) {
    return in_link(link_of(model, b, links), link_of(model, a, links).point(p));
  };
  const Vector3d c = local(shape.points[i]);
  const double eps = 1e-12 * mesh.bound();
  double s = HUGE_VAL;
  int nearest = none;
  for (const int f : faces) {
    const double height = mesh.face(f).normal.dot(c - mesh.on_face(f));
    if (std::abs(height) < std::abs(s) && is_above(mesh, f, c, eps)) s = height, nearest = f;
  }
  if (nearest == none) return {};
  const Vector3d normal = mesh.face(nearest).normal;
  if (shape.is_polytope()) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : shape.points) middle += p / static_cast<double>(shape.points.size());
    middle = local(middle);
    if (normal.dot(middle - mesh.on_face(nearest)) >= 0) return {};
    std::vector<int> around;
    const Vector3d margin = Vector3d::Constant((middle - c).norm() + std::abs(s));
    mesh.near(middle - margin, middle + margin, around);
    // A body beside an open edge is behind it with what is behind faces.
    const Side side = side_of(mesh, middle, around);
    if (!side.behind || (side.open && s > eps)) return {};
  } else if (s >= 0) {
    return {};
  }
  ContactFeature f;
  f.kind = ContactFeature::Kind::plane;
  if (shape.kind == ContactShape::Kind::cylinder)
    f.kind = ContactFeature::Kind::rim_on_plane, f.axis_a = shape.axis();
  f.a = a, f.b = b;
  f.face = nearest;
  f.place_a = shape.points[i];
  f.radius_a = shape.radius;
  f.place_b = mesh.on_face(nearest);
  f.axis_b = -normal;
  return f;
}

}  // namespace tandem::mbd
