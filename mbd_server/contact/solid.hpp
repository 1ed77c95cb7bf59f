// A shape where its link is: what the search for features asks of it many times.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mbd_server/kinematics/kinematics.hpp"
#include "mbd_server/state/contact_point.hpp"

namespace tandem::mbd {

// Stays valid while `links` stay as they are.
class Solid {
 public:
  const ContactShape& shape;
  const LinkMotion& link;
  int index;
  std::vector<Vector3d> points;  // world
  Vector3d centre;

  Solid(const Model& model, int i, const std::vector<LinkMotion>& links)
      : shape(model.contact.shape(i)),
        link(links[static_cast<std::size_t>(shape.link)]),
        index(i),
        centre(link.point(shape.centre)) {
    points.reserve(shape.points.size());
    for (const Vector3d& p : shape.points) points.push_back(link.point(p));
    normals_.reserve(shape.faces.size());
    for (const ContactShape::Face& f : shape.faces) normals_.push_back(link.R_WL * f.normal);
  }
  Vector3d local(const Vector3d& p) const { return link.R_WL.transpose() * (p - link.p_WL); }
  Vector3d turned_back(const Vector3d& d) const { return link.R_WL.transpose() * d; }
  const Vector3d& normal(std::size_t face) const { return normals_[face]; }
  // Of an edge: across the arc between the normals of its faces.
  const Vector3d& across_arc(std::size_t edge) const {
    if (across_arcs_.empty())
      for (const ContactShape::Edge& e : shape.edges)
        across_arcs_.push_back(
            normal(static_cast<std::size_t>(e.faces[1])).cross(normal(static_cast<std::size_t>(e.faces[0]))));
    return across_arcs_[edge];
  }
  const Vector3d& on_face(std::size_t face) const {
    return points[static_cast<std::size_t>(shape.faces[face].corners[0])];
  }
  double lowest(const Vector3d& n) const {
    double least = HUGE_VAL;
    for (const Vector3d& p : points) least = std::min(least, n.dot(p));
    return least;
  }

 private:
  std::vector<Vector3d> normals_;              // (faces)
  mutable std::vector<Vector3d> across_arcs_;  // (edges), when they are asked for first
};

// As find_features() of two shapes of which none is a mesh, a height field or a cylinder on faces. `apart`:
// the face, of a and then of b, above which the other one was beyond reach before; none: it is not known. It
// is looked at first, and changes nothing but the time of the search. Afterwards, the face that separates
// them.
void find_features(const Solid& a, const Solid& b, double reach, std::int64_t preferred,
                   std::vector<ContactFeature>& features, int& apart);

}  // namespace tandem::mbd
