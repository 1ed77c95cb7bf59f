// Every law behind one run-time switch: the reference of the specialised variants, and what runs when none
// matches.
#pragma once

#include "dem_server/laws/cohesive.hpp"
#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/hooke.hpp"
#include "dem_server/laws/paper.hpp"

namespace tandem::dem {

struct GenericLaw {
  // extended: it is given all that a contact has, and the scene's rolling and twisting act beside it.
  static constexpr bool tangential = true, extended = true;

  // Is there a contact at this overlap? `existed`: in the last step.
  template <class Real>
  TANDEM_HD static bool touches(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t law,
                                bool existed) {
    if (c.overlap > 0) return true;
    return existed && static_cast<scene::ContactLaw>(law) == scene::ContactLaw::jkr && Jkr::holds(c, k);
  }

  template <class Real>
  TANDEM_HD ContactForce<Real> operator()(const Contact<Real>& c, const Coefficients<Real>& k,
                                          std::uint32_t law, Vec3<Real>& spring) const {
    switch (static_cast<scene::ContactLaw>(law)) {
      case scene::ContactLaw::hertz_mindlin:
        return HertzMindlin{}(c, k, law, spring);
      case scene::ContactLaw::hertz_frictionless:
        return HertzFrictionless{}(c, k, law, spring);
      case scene::ContactLaw::paper:
        return Paper{}(c, k, law, spring);
      case scene::ContactLaw::hooke:
        return Hooke{}(c, k, law, spring);
      case scene::ContactLaw::jkr:
        return Jkr{}(c, k, law, spring);
      case scene::ContactLaw::sjkr:
        return Sjkr{}(c, k, law, spring);
    }
    return {};
  }
};

}  // namespace tandem::dem
