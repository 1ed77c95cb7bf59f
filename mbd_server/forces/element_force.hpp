// Forces of machine elements, with their states of first order eliminated.
//
// The states of an element obey z' = g(t, s, v, z), with s and v its argument and the rate of it. Within a
// step they are the root of z = z_known + z_weight g (State::z_weight), a function of s and v: the force
// f(t, s, v, z(s, v)) is one of s and v alone, with the derivatives
//   df/ds = f_s + f_z (1 - z_weight g_z)^-1 z_weight g_s,   likewise df/dv.
//
// At rest (State::at_rest) they are the root of g(t, s, v = 0, z) = 0, a function of s alone. Where g leaves
// them undetermined they have the value to which a motion from the start would bring them:
//   closed valve       each chamber keeps its mass of oil, or, with leakage, both together: V e^(p/B)
//   control of a rate  with the target 0 the integral is -s, but for a constant: z + s
//   control of s       the integral is the multiplier of the condition that the error vanishes. z_known is
//   its
//                      last value, and z = z_known + z_weight g as within a step
#pragma once

#include <optional>

#include "mbd_server/forces/element_law.hpp"
#include "mbd_server/forces/force_element.hpp"

namespace tandem::mbd {

// Motor on a joint coordinate, or cylinder between two points.
struct Element {
  std::string name;       // motor "x", cylinder "y"
  LinkIndex link = none;  // of a motor: the link whose coordinate it drives; none: a cylinder
  PointOnBody a, b;       // of a cylinder
  double length = 0;      // of a cylinder at stroke 0 [m]
  Signal signal;          // target, throttle, force or opening of the valve
  std::shared_ptr<const ElementLaw> law;
  double rotor = 0;    // inertia of a motor's rotor, as felt by the coordinate [kg m2]
  double damping = 0;  // [N s/m]
  std::optional<scene::Friction> friction;
  Signal brake;  // share of the friction that acts; without a signal all of it
  std::optional<scene::Limits> ends;
  int state = 0, states = 0;  // first of its states, and how many
  int account = none;         // see Model::accounts

  bool is_cylinder() const { return link == none; }
  // Its law where it is of that kind, else null.
  template <class Law>
  const Law* law_as() const {
    return dynamic_cast<const Law*>(law.get());
  }
};

std::shared_ptr<const ForceElement> make_force(Element element);

ElementValue evaluate(const Element& element, const Model& model, const State& state, double s, double v);
ElementDerivatives derivatives(const Element& element, const Model& model, const State& state, double s,
                               double v);

ElementArgument argument(const Element& element, const std::vector<LinkMotion>& links);
// Force of a cylinder at its ends, as that of a spring.
SpringForce along_line(const Element& element, const ElementValue& value,
                       const std::vector<LinkMotion>& links);

// What its law depends on at a state: value of its target, throttle, force or opening; no states.
LawInput input_of(const Element& element, const Model& model, const State& at);

ElementPower power(const Element& element, const Model& model, const State& at, ElementArgument x,
                   const StatesOfElement& z);
// Energy stored by its law and at the ends [J].
double stored_energy(const Element& element, double s, const StatesOfElement& z);

StatesOfElement states_of(const Element& element, const VectorXd& z);

}  // namespace tandem::mbd
