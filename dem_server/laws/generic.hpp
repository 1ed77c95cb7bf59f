// Every law behind one run-time switch: the reference of the specialised variants, and what runs when none
// matches.
#pragma once

#include "common/scene/model.hpp"
#include "dem_server/laws/cohesive.hpp"
#include "dem_server/laws/hertz.hpp"
#include "dem_server/laws/hooke.hpp"
#include "dem_server/laws/law.hpp"
#include "dem_server/laws/paper.hpp"

namespace tandem::dem {

#define LAW(name, Functor) static_assert(ContactLaw<Functor>);
#include "dem_server/laws/laws.def"
#undef LAW

// The constants of a pair of materials under a law.
inline PairConstants<double> pair_constants(scene::ContactLaw law, const scene::Pair& pair,
                                            const scene::Material& a, const scene::Material& b) {
  switch (law) {
#define LAW(name, Functor)      \
  case scene::ContactLaw::name: \
    return Functor::constants(pair, a, b);
#include "dem_server/laws/laws.def"
#undef LAW
  }
  return {};
}

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
#define LAW(name, Functor)      \
  case scene::ContactLaw::name: \
    return Functor{}(c, k, law, spring);
#include "dem_server/laws/laws.def"
#undef LAW
    }
    return {};
  }
};

}  // namespace tandem::dem
