#include "mbd_server/io/tyre_bottoming.hpp"

#include <algorithm>
#include <cmath>

#include "mbd_server/forces/tyre.hpp"

namespace tandem::mbd {

TyreBottoming::TyreBottoming(const Model& model) : model_(model), all_(forces_of<TyreOnLink>(model)) {
  const std::vector<ContactShape>& shapes = model.contact.shapes;
  const auto touches_ground = [&](int s) {
    for (std::size_t g = 0; g < shapes.size(); ++g)
      if (shapes[g].link == 0 && model.contact.may_touch(s, static_cast<int>(g))) return true;
    return false;
  };
  for (std::size_t t = 0; t < all_.size(); ++t)
    for (std::size_t s = 0; s < shapes.size(); ++s)
      if (shapes[s].link == all_[t]->centre.link && touches_ground(static_cast<int>(s))) {
        tyres_.push_back(t);
        break;
      }
}

TyreTotals TyreBottoming::totals() const {
  TyreTotals totals;
  if (model_.contact.empty()) return totals;
  totals.time.assign(all_.size(), 0);
  totals.bottomed = totals.bottomed_at = totals.time;
  totals.bottomed_shape.assign(all_.size(), none);
  return totals;
}

// A plane road is no shape of contact: the ground of the tyre is what lies in that plane.
bool TyreBottoming::is_on_ground_of(const TyreOnLink& tyre, const std::vector<LinkMotion>& links,
                                    const ContactForce& f, int shape) const {
  if (tyre.road) return stands_on(tyre, links, shape);
  constexpr double same = 1e-3;  // as the scene's check: angle, and distance over the radius
  return tyre.normal.cross(f.n).norm() < same &&
         std::abs(tyre.normal.dot(f.p) - tyre.height) < same * tyre.radius - f.gap;
}

void TyreBottoming::add_step(const State& state, const std::vector<LinkMotion>& links, double h,
                             TyreTotals& totals) const {
  for (const std::size_t t : tyres_) {
    const TyreOnLink& tyre = *all_[t];
    if (!(load_on(tyre, links) > 0)) continue;
    totals.time[t] += h;
    for (const ContactPoint& point : state.contacts) {
      int shape = point.feature.a, other = point.feature.b;
      if (model_.contact.shape(shape).link == 0) std::swap(shape, other);
      if (model_.contact.shape(shape).link != tyre.centre.link || model_.contact.shape(other).link != 0)
        continue;
      const ContactForce f = evaluate(model_, point, links, Derivatives::without);
      if (!(f.normal > 0) || !is_on_ground_of(tyre, links, f, other)) continue;
      if (totals.bottomed_shape[t] == none)
        totals.bottomed_at[t] = state.time, totals.bottomed_shape[t] = shape;
      totals.bottomed[t] += h;
      break;
    }
  }
}

std::optional<TyreBottoming::Longest> TyreBottoming::longest(const TyreTotals& totals) const {
  if (totals.time.empty()) return {};
  Longest most;
  for (std::size_t t = 0; t < totals.time.size(); ++t) {
    const double share = totals.bottomed[t] > 0 ? totals.bottomed[t] / totals.time[t] : 0;
    if (share <= most.share) continue;
    most = {share, totals.bottomed_at[t],
            model_.contact.shape(static_cast<int>(totals.bottomed_shape[t])).name + " and tyre \"" +
                all_[t]->name + "\""};
  }
  return most;
}

}  // namespace tandem::mbd
