// Balls that touch meshes. A step holds the faces, edges and corners that balls touch at its begin; a `watch`
// for each ball near a mesh sees where another part is nearest at the end, and where the ball begins to touch
// one more.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbd_server/contact/mesh_features.hpp"
#include "mbd_server/contact/touch.hpp"
#include "mbd_server/step/contact_candidates.hpp"

namespace tandem::mbd {
namespace {

// A contact of a ball continues where the place of contact moves by less than this share of the radius, of a
// corner by less than this share of the size of its body.
constexpr double same_foot_of_ball = 0.25, same_foot_of_corner = 0.05;
// A ball that begins to touch a surface so deep, as a share of the thinner shape, came from behind.
constexpr double from_behind = 0.1;

}  // namespace

double ContactCandidates::same_foot(const ContactFeature& f) const {
  return f.radius_a > 0 ? same_foot_of_ball * f.radius_a
                        : same_foot_of_corner * model_.contact.shape(f.a).bound;
}

// The features of the ball at present that are not those with which it touches. Where `gaps` is given, it
// gets how far these are from the ones that the step holds, and the watch the distance to the back of a face.
// Returns that back, where the ball is behind an open mesh and touches nothing.
std::optional<ContactFeature> ContactCandidates::uncovered(const std::vector<LinkMotion>& links,
                                                           const BallWatch& watch,
                                                           std::vector<ContactFeature>& found,
                                                           ContactGaps* gaps) const {
  found.clear();
  std::optional<ContactFeature> behind;
  watched_features(model_, all_[watch.candidate].feature, links, watch.reach, watch.depth, found,
                   watch.held.empty() ? &behind : nullptr);
  if (gaps) {
    ContactGap& g = (*gaps)[watch.candidate];
    g = {watch.reach, 0};
    if (behind) g.value = gap(model_, *behind, links, &g.rate);
  }
  for (const std::size_t k : watch.held) {
    const ContactFeature& held = all_[k].feature;
    const Vector3d at = foot(model_, held, links);
    double nearest = same_foot(held);
    auto continued = found.end();
    for (auto f = found.begin(); f != found.end(); ++f)
      if (const double distance = (f->place_b - at).norm(); distance < nearest)
        nearest = distance, continued = f;
    if (gaps) {
      ContactGap& g = (*gaps)[k];
      g.off = g.since = 0;
      if (continued != found.end()) {
        double rate = 0;
        const double value = gap(model_, *continued, links, &rate);
        g.off = value - g.value;
        if (g.off < 0) {
          if (rate < g.rate) g.since = g.off / (rate - g.rate);
        } else if (g.off > 0) {
          const Touch t = touch(model_, held, links, Derivatives::without);
          const Vector3d c = link_of(model_, held.a, links).point(held.place_a),
                         v = at_point(link_of(model_, held.a, links).V - link_of(model_, held.b, links).V, c);
          const double along = (v - t.n.dot(v) * t.n).norm();
          if (along > 0) g.since = nearest / along;
        }
      }
    }
    if (continued != found.end()) found.erase(continued);
  }
  return behind;
}

// The distance of the nearest one that does not touch yet.
void ContactCandidates::measure_watch(const std::vector<LinkMotion>& links,
                                      const std::vector<ContactFeature>& found, ContactGap& g) const {
  for (const ContactFeature& f : found) {
    double rate = 0;
    if (const double value = gap(model_, f, links, &rate); value < g.value) g = {value, rate};
  }
}

// What the ball of the watch begins to touch.
void ContactCandidates::find_beginning(const std::vector<LinkMotion>& links, const BallWatch& watch,
                                       bool at_start) {
  beginning_.clear();
  if (const auto back = uncovered(links, watch, features_, nullptr)) expect_in_front(links, *back, at_start);
  for (const ContactFeature& f : features_) {
    double rate = 0;
    const double distance = gap(model_, f, links, &rate), near = rules_.tolerance(f);
    if (!(distance <= near) || (rate > 0 && distance >= -near)) continue;
    // A corner that is no longer one of several in contact may begin deep.
    const bool alone = f.radius_a > 0 || of_pair(pair_of(f)).empty();
    if (!at_start && alone && -distance > from_behind * thickness_at(model_, f))
      fail_from_behind(links, f, false);
    beginning_.push_back({f, std::max(0.0, -rate)});
  }
}

// Throws where a point touches the back of an open mesh.
void ContactCandidates::expect_in_front(const std::vector<LinkMotion>& links, const ContactFeature& back,
                                        bool at_start) const {
  double rate = 0;
  const double distance = gap(model_, back, links, &rate);
  if (distance > rules_.tolerance() || (!at_start && rate >= 0 && distance >= -rules_.tolerance())) return;
  fail_from_behind(links, back, at_start);
}

void ContactCandidates::fail_from_behind(const std::vector<LinkMotion>& links, const ContactFeature& f,
                                         bool at_start) const {
  const Vector3d p = model_.origin + link_of(model_, f.a, links).point(f.place_a);
  throw Error(
      at_start ? ErrorCode::scene : ErrorCode::numerics,
      fmt::format("{} {} {} from behind its surface, at [{:.4g}, {:.4g}, {:.4g}]",
                  model_.contact.shape(f.a).name, at_start ? "touches" : "comes to",
                  model_.contact.shape(f.b).name, p.x(), p.y(), p.z()),
      "mbd.contact",
      "an open mesh is touched from the side as seen from which its triangles wind counter-clockwise, a "
      "height field from above: reverse the winding, close the mesh, or place the body on that side");
}

// Centre of the ball of a watch, in the frame of the mesh.
Vector3d ContactCandidates::on_mesh(const std::vector<LinkMotion>& links, const ContactFeature& watch) const {
  return in_link(link_of(model_, watch.b, links), link_of(model_, watch.a, links).point(watch.place_a));
}

void ContactCandidates::mark_balls(const std::vector<LinkMotion>& links) {
  for (BallWatch& watch : watches_) watch.centre = on_mesh(links, all_[watch.candidate].feature);
}

// Whether the centre of a ball has gone through a face in the step, although nothing presses it so deep.
bool ContactCandidates::went_through(const std::vector<LinkMotion>& links, const ContactGaps& gaps) const {
  std::vector<ContactMesh::Crossing> crossings;
  return std::ranges::any_of(watches_, [&](const BallWatch& watch) {
    const ContactFeature& f = all_[watch.candidate].feature;
    if (!(f.radius_a > 0)) return false;
    if (std::ranges::any_of(watch.held, [&](std::size_t k) { return gaps[k].value <= -f.radius_a; }))
      return false;
    const Vector3d along = on_mesh(links, f) - watch.centre;
    // A ball is no nearer to a face that it does not touch; an end of a cylinder may be.
    if (along.norm() < f.radius_a && f.axis_a.isZero(0)) return false;
    model_.contact.shape(f.b).mesh->meet(watch.centre, along, crossings);
    return !crossings.empty() && crossings[0].distance <= 1;
  });
}

// Throws where a corner or an edge comes through the flat end of a cylinder.
void ContactCandidates::expect_round_side(const ContactFeature& f, double gap) const {
  for (const int i : {f.a, f.b}) {
    const ContactShape& shape = model_.contact.shape(i);
    if (shape.kind != ContactShape::Kind::cylinder || -gap <= from_behind * thickness_at(model_, f)) continue;
    throw Error(
        ErrorCode::numerics,
        fmt::format("{} comes with its flat end to {}, and is {:.3g} m deep in it", shape.name,
                    model_.contact.shape(f.a + f.b - i).name, -gap),
        "mbd.contact",
        "cylinders touch as wheels do, with their round side: give it a convex_hull as its shape of contact");
  }
}

}  // namespace tandem::mbd
