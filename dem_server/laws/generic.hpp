// Every law behind one run-time switch: the reference for the specialised variants, and the variant that runs
// when no other matches.
#pragma once

#include <type_traits>

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

// f(law) for the law of a scene.
template <class F>
auto with_law(scene::ContactLaw law, F f) {
  switch (law) {
#define LAW(name, Functor)      \
  case scene::ContactLaw::name: \
    return f(Functor{});
#include "dem_server/laws/laws.def"
#undef LAW
  }
  return decltype(f(HertzMindlin{})){};
}

// The constants of a pair of materials under a law.
inline PairConstants<double> pair_constants(scene::ContactLaw law, const scene::Pair& pair,
                                            const scene::Material& a, const scene::Material& b) {
  return with_law(law, [&](auto l) { return decltype(l)::constants(pair, a, b); });
}

// Is there a contact at this overlap under law L? `existed`: there was one in the last micro step.
template <class L, class Real>
TANDEM_HD bool in_contact(const Contact<Real>& c, const Coefficients<Real>& k, bool existed) {
  bool lasts = false;
  if constexpr (std::is_same_v<L, Jkr>) lasts = existed && Jkr::holds(c, k);
  return c.overlap > 0 || lasts;
}

struct GenericLaw {
  // extended: the loop computes sizes, masses and adhesion for it, and adds the scene's rolling and twisting.
  static constexpr bool tangential = true, extended = true, belts = true;

  template <class Real>
  TANDEM_HD static bool in_contact(const Contact<Real>& c, const Coefficients<Real>& k, std::uint32_t law,
                                   bool existed) {
    if (c.overlap > 0) return true;
    return static_cast<scene::ContactLaw>(law) == scene::ContactLaw::jkr &&
           dem::in_contact<Jkr>(c, k, existed);
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
