// Pairs of near shapes: bounding spheres, sorted along one axis.
#include <algorithm>
#include <cmath>

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {
namespace {

struct Bound {
  Vector3d centre;
  double radius, travel;  // of the sphere; within the time [m]
};

}  // namespace

void find_pairs(const Model& model, const std::vector<LinkMotion>& links, double h,
                std::vector<NearPair>& pairs, const std::vector<double>* travel) {
  pairs.clear();
  const BodyContactModel& contact = model.contact;
  const int count = static_cast<int>(std::ssize(contact.shapes));
  std::vector<Bound> bounds(contact.shapes.size());
  std::vector<int> order, planes;
  for (int i = 0; i < count; ++i) {
    const ContactShape& shape = contact.shape(i);
    const LinkMotion& link = links[static_cast<std::size_t>(shape.link)];
    Bound& bound = bounds[static_cast<std::size_t>(i)];
    bound.centre = link.point(shape.centre);
    bound.radius = shape.bound;
    const double speed = at_point(link.V, bound.centre).norm() + link.V.head<3>().norm() * shape.bound;
    bound.travel = shape.link == 0 ? 0 : h * speed + h * h * model.gravity.norm();
    if (travel) bound.travel = (*travel)[static_cast<std::size_t>(i)];
    (shape.kind == ContactShape::Kind::plane ? planes : order).push_back(i);
  }
  const auto low = [&](int i) {
    const Bound& b = bounds[static_cast<std::size_t>(i)];
    return b.centre.x() - b.radius - b.travel;
  };
  std::sort(order.begin(), order.end(), [&](int i, int k) {
    const double x = low(i), y = low(k);
    return x < y || (x == y && i < k);
  });
  for (std::size_t n = 0; n < order.size(); ++n) {
    const int i = order[n];
    const Bound& one = bounds[static_cast<std::size_t>(i)];
    const double high = one.centre.x() + one.radius + one.travel;
    for (std::size_t m = n + 1; m < order.size() && low(order[m]) <= high; ++m) {
      const int k = order[m];
      const Bound& two = bounds[static_cast<std::size_t>(k)];
      const double reach = one.travel + two.travel;
      if ((one.centre - two.centre).norm() > one.radius + two.radius + reach) continue;
      if (contact.may_touch(i, k)) pairs.push_back({std::min(i, k), std::max(i, k), reach});
    }
    for (const int p : planes) {
      const ContactShape& plane = contact.shape(p);
      const LinkMotion& link = links[static_cast<std::size_t>(plane.link)];
      const double distance = (link.R_WL * plane.axes.col(2)).dot(one.centre - link.point(plane.centre));
      // A plane that moves turns about its link: all of it counts as near.
      const double reach = plane.link == 0 ? one.travel : HUGE_VAL;
      if (distance - one.radius <= reach && contact.may_touch(i, p))
        pairs.push_back({std::min(i, p), std::max(i, p), reach});
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const NearPair& x, const NearPair& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
}

}  // namespace tandem::mbd
