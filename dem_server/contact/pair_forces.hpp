// The forces that a sphere's neighbours exert on it: gathered, each sphere owns its contacts, so nothing is
// added atomically between spheres; a pair is evaluated from both sides with bitwise opposite results.
#pragma once

#include "dem_server/contact/approach.hpp"
#include "dem_server/contact/extension.hpp"
#include "dem_server/core/fetch.hpp"
#include "dem_server/core/gather.hpp"
#include "dem_server/model/view.hpp"

namespace tandem::dem {

// Evaluates the law with the contact's history, which a law without friction has not.
template <class Law, class Real>
TANDEM_HD ContactForce<Real> contact_force(const Contact<Real>& c, const Coefficients<Real>& k,
                                           std::uint32_t law, History<Real>* history, std::uint32_t stamp) {
  Vec3<Real> spring;
  if constexpr (Law::tangential) {
    const History<Real> h = *history;
    // Touched in the last step: the contact goes on. Otherwise it is new.
    if (h.stamp == stamp - 1) spring = h.spring;
  }
  const ContactForce<Real> f = Law{}(c, k, law, spring);
  if constexpr (Law::tangential) *history = {spring, stamp};
  return f;
}

template <class Law, class Real>
struct PairForces {
  static constexpr bool with_torque = Law::tangential;

  const View<Real>& view;
  const Instant& now;
  const ListView<Real>& list = view.pairs[now.list_side];
  const Place<Real>* place = view.place[now.state_side];
  const Drift<Real>* drift = view.drift[now.state_side];
  const Spin<Real>* spin = view.spin[now.state_side];
  Real dt = static_cast<Real>(now.dt);

  // How far beyond touching there may be a contact.
  TANDEM_HD auto range() const {
    if constexpr (Law::extended)
      return view.parameters.range;
    else
      return typename LengthUnit<Real>::Count{};
  }

  // Spheres beyond the last have no entries: a GPU's threads come in whole warps.
  TANDEM_HD std::uint32_t begin(std::uint32_t i) const { return i < view.n ? fetch(list.start + i) : 0; }
  TANDEM_HD std::uint32_t end(std::uint32_t i) const { return i < view.n ? fetch(list.start + i + 1) : 0; }
  TANDEM_HD Place<Real> own(std::uint32_t i) const { return i < view.n ? fetch(place + i) : Place<Real>{}; }

  // False only where neighbour entry k does not touch a sphere at `own`.
  TANDEM_HD bool may_touch(const Place<Real>& own, std::uint32_t k) const {
    return Approach<Real>::may_touch(own, fetch(place + fetch(list.entry + k)), range());
  }

  // What neighbour entry k does to sphere i.
  template <class Tally>
  TANDEM_HD PairForce<Real> of(std::uint32_t i, std::uint32_t k, Tally& tally) const {
    const std::uint32_t j = fetch(list.entry + k);
    const Place<Real> own = fetch(place + i), other = fetch(place + j);
    const Drift<Real> own_drift = fetch(drift + i), other_drift = fetch(drift + j);
    const Approach<Real> approach(own, other, range());
    if (!approach.touching()) return {};
    const Parameters<Real>& p = view.parameters;
    const Real radius = p.radius(own), other_radius = p.radius(other);
    const Coefficients<Real> c = p.between(own_drift.kind, radius, other_drift.kind, other_radius);
    Contact<Real> contact;
    contact.overlap = approach.overlap(p.unit, contact.n);
    [[maybe_unused]] Extension<Real> extension;
    [[maybe_unused]] bool existed = false;
    if constexpr (Law::extended) {
      contact.overlap -= p.unit.metres(p.range);
      extension = extend(view, contact, p.material(own_drift.kind), radius, p.material(other_drift.kind),
                         other_radius);
      existed = list.history[k].stamp == now.stamp - 1;
      if (!Law::touches(contact, c, p.law, existed)) return {};
    }
    const Real arm = radius - contact.overlap / 2, other_arm = other_radius - contact.overlap / 2;
    Vec3<Real> u = own_drift.v - other_drift.v;
    if constexpr (Law::tangential)
      u -= cross(arm * fetch(spin + i).w + other_arm * fetch(spin + j).w, contact.n);
    contact.normal_speed = dot(u, contact.n);
    contact.slip = u - contact.normal_speed * contact.n;
    contact.dt = dt;

    const ContactForce<Real> f =
        contact_force<Law>(contact, c, p.law, Law::tangential ? list.history + k : nullptr, now.stamp);
    tally.observe_overlap(static_cast<float>(contact.overlap * c.curvature));
    PairForce<Real> on_us;
    on_us.force = f.normal * contact.n + f.tangential;
    if constexpr (Law::tangential) on_us.torque = arm * cross(f.tangential, contact.n);
    if constexpr (Law::extended)
      on_us.torque +=
          turning_moment(view, contact, f, extension, c.friction, fetch(spin + i).w - fetch(spin + j).w,
                         list.turn == nullptr ? nullptr : list.turn + k, existed);
    return on_us;
  }
};

}  // namespace tandem::dem
