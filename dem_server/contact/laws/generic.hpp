// Every law behind one run-time switch: the reference of the specialised variants, and what runs when none
// matches.
#pragma once

#include "dem_server/contact/laws/hertz.hpp"
#include "dem_server/contact/laws/paper.hpp"

namespace tandem::dem {

struct GenericLaw {
  static constexpr bool tangential = true;

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
    }
    return {};
  }
};

}  // namespace tandem::dem
