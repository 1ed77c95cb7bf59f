// The one list of the fields of a state.
#pragma once

#include "mbd_server/state/state.hpp"

namespace tandem::mbd {

// Calls f(name, field) for every field; `state` is a State or const State.
template <class AnyState, class F>
void for_each_field(AnyState& state, F&& f) {
  f("time", state.time);
  f("step", state.step);
  f("steps", state.steps);
  f("q", state.q);
  f("u", state.u);
  f("udot", state.udot);
  f("a", state.a);
  f("udot_rate", state.udot_rate);
  f("lambda", state.lambda);
  f("z", state.z);
  f("zdot", state.zdot);
  f("w", state.w);
  f("zdot_rate", state.zdot_rate);
  f("inputs", state.inputs);
  f("next_step", state.next_step);
  f("last_error", state.last_error);
  f("loads", state.loads);
  f("load_rates", state.load_rates);
  f("load_time", state.load_time);
  f("contact_step", state.contact_step);
  f("stops", state.stops);
  f("sliding", state.sliding);
  f("contacts", state.contacts);
  f("touch_step", state.touch_step);
  f("island_steps", state.island_steps);
  f("contact_wrench", state.contact_wrench);
  f("coarse", state.coarse);
  f("fine", state.fine);
}

}  // namespace tandem::mbd
