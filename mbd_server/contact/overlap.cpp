#include "mbd_server/contact/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/touch.hpp"

namespace tandem::mbd {
namespace {

// Depth of a point below the surface of a convex shape in the frame of its link; negative outside.
double depth_in(const ContactShape& shape, const Vector3d& p) {
  if (shape.is_polytope()) {
    double least = HUGE_VAL;
    for (const ContactShape::Face& face : shape.faces)
      least = std::min(least, face.normal.dot(shape.points[static_cast<std::size_t>(face.corners[0])] - p));
    return least;
  }
  const Vector3d& a = shape.points[0];
  if (shape.points.size() == 1) return shape.radius - (p - a).norm();
  const Vector3d d = shape.points[1] - a;
  const double along = d.dot(p - a) / d.squaredNorm();
  if (shape.kind == ContactShape::Kind::cylinder)
    return std::min({along * d.norm(), (1 - along) * d.norm(), shape.radius - (p - a - along * d).norm()});
  return shape.radius - (p - a - std::clamp(along, 0.0, 1.0) * d).norm();
}

}  // namespace

std::string files_of(const ContactShape& a, const ContactShape& b) {
  std::string text;
  for (const ContactShape* s : {&a, &b})
    if (!s->file.empty()) text += "; " + s->file;
  return text;
}

Overlap find_overlap(const Model& model, int body, int mesh, const std::vector<LinkMotion>& links,
                     double share) {
  const ContactShape& a = model.contact.shape(body);
  const ContactMesh& surface = *model.contact.shape(mesh).mesh;
  const LinkMotion &link_a = link_of(model, body, links), &link_b = link_of(model, mesh, links);
  Overlap deepest;
  const auto add = [&](double depth, double thinner) {
    if (depth > share * thinner && depth > deepest.depth) deepest = {depth, thinner};
  };
  // In the frame of the mesh.
  const auto local = [&](const Vector3d& p) { return in_link(link_b, link_a.point(p)); };
  const auto add_point = [&](const Vector3d& p) {
    if (!surface.encloses(p)) return;
    const auto [distance, face] = surface.distance(p);
    // A corner has no radius; the axis of a cylinder ends at its flat ends.
    const double radius = a.kind == ContactShape::Kind::cylinder ? 0 : a.radius;
    add(distance + radius, std::min(a.thickness, surface.face(face).thickness));
  };
  for (const Vector3d& p : a.points) add_point(local(p));
  add_point(local(a.centre));
  // The middles of what is inside of each edge and axis.
  std::vector<ContactMesh::Crossing> crossings;
  for (const ContactShape::Edge& edge : a.edges) {
    const Vector3d from = local(a.points[static_cast<std::size_t>(edge.from)]),
                   along = local(a.points[static_cast<std::size_t>(edge.to)]) - from;
    surface.meet(from, along, crossings);
    double last = 0;
    for (const ContactMesh::Crossing& c : crossings) {
      if (c.distance >= 1) break;
      add_point(from + 0.5 * (last + c.distance) * along);
      last = c.distance;
    }
    if (last > 0) add_point(from + 0.5 * (last + 1) * along);
  }
  for (const Vector3d& p : surface.points()) add(depth_in(a, in_link(link_a, link_b.point(p))), a.thickness);
  return deepest;
}

}  // namespace tandem::mbd
