#include "mbd_server/step/richardson.hpp"

#include "common/error.hpp"

namespace tandem::mbd {
namespace {

// Calls f for each quantity of a run of its own, in the order of packing.
template <class AnyState, class F>
void for_each_own(AnyState& run, F&& f) {
  Eigen::Index begin = 0;
  for (auto* field : {&run.q, &run.u, &run.udot, &run.a, &run.udot_rate, &run.lambda, &run.z, &run.zdot,
                      &run.w, &run.zdot_rate}) {
    f(*field, begin);
    begin += field->size();
  }
}

void pack(const State& run, VectorXd& packed) {
  packed.resize(packed_size(run));
  for_each_own(
      run, [&](const VectorXd& field, Eigen::Index begin) { packed.segment(begin, field.size()) = field; });
}

// Restores the run that is stored in `packed`, at the time and under the loads of the state.
void unpack(const State& state, const VectorXd& packed, double step, State& run) {
  if (packed.size() != packed_size(state))
    throw Error(ErrorCode::scene, "the state holds no runs to extrapolate from", "mbd_server",
                "continue with mbd.integrator.extrapolate = false, or from a state that was saved with it");
  run.time = state.time;
  run.side = state.side;
  run.step = step;
  run.inputs = state.inputs;
  run.loads = state.loads;
  run.load_rates = state.load_rates;
  run.load_time = state.load_time;
  for_each_own(run,
               [&](VectorXd& field, Eigen::Index begin) { field = packed.segment(begin, field.size()); });
}

}  // namespace

Richardson::Richardson(GeneralizedAlpha& method, const State& state)
    : method_(method),
      coarse_(state),
      fine_(state),
      before_(state),
      difference_(VectorXd::Zero(state.u.size())) {}

void Richardson::start(System& system, State& state, double h) {
  coarse_ = state;
  coarse_.coarse.resize(0), coarse_.fine.resize(0);
  fine_ = coarse_;
  method_.start(system, coarse_, h);
  method_.start(system, fine_, h / 2);
  state.step = coarse_.step;
  combine(system, state);
}

void Richardson::jump(System& system, State& state) {
  unpack(state, state.coarse, state.step, coarse_);
  unpack(state, state.fine, state.step / 2, fine_);
  method_.jump(system, coarse_);
  method_.jump(system, fine_);
  combine(system, state);
}

void Richardson::jump(System& system, const State& before, State& state) {
  unpack(state, state.coarse, state.step, coarse_);
  unpack(state, state.fine, state.step / 2, fine_);
  unpack(before, before.coarse, before.step, before_);
  method_.jump(system, before_, coarse_);
  unpack(before, before.fine, before.step / 2, before_);
  method_.jump(system, before_, fine_);
  combine(system, state);
}

void Richardson::step(System& system, State& state, double h) {
  unpack(state, state.coarse, state.step, coarse_);
  unpack(state, state.fine, state.step / 2, fine_);
  method_.step(system, coarse_, h);
  method_.step(system, fine_, h / 2);
  method_.step(system, fine_, h / 2);
  state.time += h;
  state.step = h;
  ++state.steps;
  combine(system, state);
}

void Richardson::combine(System& system, State& state) {
  system.difference(coarse_.q, fine_.q, difference_);
  difference_ /= 3;
  system.move(fine_.q, difference_, state.q);
  state.u = fine_.u + (fine_.u - coarse_.u) / 3;
  state.udot = fine_.udot + (fine_.udot - coarse_.udot) / 3;
  state.a = fine_.a;
  state.lambda = fine_.lambda + (fine_.lambda - coarse_.lambda) / 3;
  if (state.z.size() > 0) {
    state.z = fine_.z + (fine_.z - coarse_.z) / 3;
    state.zdot = fine_.zdot + (fine_.zdot - coarse_.zdot) / 3;
    state.w = fine_.w;
  }
  pack(coarse_, state.coarse);
  pack(fine_, state.fine);
}

}  // namespace tandem::mbd
