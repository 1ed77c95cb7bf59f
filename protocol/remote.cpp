#include "protocol/remote.hpp"

#include "protocol/checks.hpp"
#include "protocol/link.hpp"
#include "protocol/registration.hpp"

namespace tandem::protocol {

struct Remote::State {
  State(std::unique_ptr<Channel> c, Role role, RunIdentity i, FrameSink* recorder)
      : channel(std::move(c)), identity(i), link(*channel, role, Sender::coordinator, recorder) {}

  std::unique_ptr<Channel> channel;
  RunIdentity identity;
  Link link;
  std::chrono::milliseconds patience{std::chrono::seconds(60)};
  std::function<void()> idle;
  BoundaryBodies bodies;
  std::uint64_t capabilities = 0;
  std::string program;
  Kind order{};    // last order
  Window ordered;  // window of that order
  MotionSet motion;
  LoadSet load;
  TangentSet tangents;
  BodiesFrame bodies_frame;
  ReceivedParticles received_particles;
  ParticlesFrame particles_frame;

  Deadline deadline() const { return Clock::now() + patience; }

  template <class... Value>
  void send(Kind kind, const Value&... value) {
    order = kind;
    link.send(kind, value..., deadline());
  }
  // The session's table accepts only the answer to the last order.
  Kind answer() {
    const std::string awaited = "the answer to " + std::string(name(order));
    return link.receive(deadline(), awaited.c_str(), idle);
  }
  void answer_nothing() {
    answer();
    link.read_nothing();
  }
};

Remote::Remote(std::unique_ptr<Channel> channel, Role role, RunIdentity identity, FrameSink* recorder)
    : state_(std::make_unique<State>(std::move(channel), role, identity, recorder)) {}
Remote::~Remote() = default;

Hello Remote::register_peer(std::uint64_t needed_capabilities, std::chrono::milliseconds patience) {
  State& s = *state_;
  const Deadline deadline = Clock::now() + patience;
  Hello hello;
  try {
    s.link.receive(deadline, "hello", s.idle);
    s.link.read(hello);
    const Version version =
        admit(hello, s.link.header().version, s.link.session().role(), needed_capabilities, peer());
    s.link.adopt(s.identity, version);
  } catch (const ProtocolError& e) {
    // The participant gets the reason, if it still receives; this error is the one that counts.
    try {
      s.link.session().step(Kind::hello, Sender::participant);
    } catch (const Error&) {
    }
    try {
      s.link.send(Kind::refuse, Failure{e.code(), e.problem(), e.where(), e.hint()}, deadline);
    } catch (const Error&) {
    }
    throw e;
  }
  s.capabilities = hello.capabilities;
  s.program = hello.program;
  s.send(Kind::welcome);
  return hello;
}

Configured Remote::configure(const Configuration& configuration) {
  State& s = *state_;
  s.link.vouch(Kind::configure, [&] { check_values(configuration); });
  s.send(Kind::configure, configuration);
  s.answer();
  Configured configured;
  s.link.read(configured);
  s.link.check([&] {
    check_values(configured);
    if (s.link.session().role() == Role::mbd) s.bodies.assign(configured.boundary);
  });
  return configured;
}

void Remote::start_predict(const Window& window) {
  State& s = *state_;
  s.link.vouch(Kind::predict, [&] { s.link.progress().expect(window); });
  s.ordered = window;
  s.send(Kind::predict, window);
}

void Remote::start_extrapolate(const Window& window) {
  State& s = *state_;
  s.link.vouch(Kind::extrapolate, [&] { s.link.progress().expect(window); });
  s.ordered = window;
  s.send(Kind::extrapolate, window);
}

void Remote::start_advance(const LoadSet& loads) {
  State& s = *state_;
  s.link.vouch(Kind::advance_mbd, [&] {
    s.link.progress().expect(loads.window);
    s.bodies.expect_some(loads.bodies);
    check_values(loads);
  });
  s.ordered = loads.window;
  s.send(Kind::advance_mbd, loads);
}

const MotionSet& Remote::finish_motion() {
  State& s = *state_;
  s.answer();
  s.link.read(s.motion);
  s.link.check([&] {
    s.link.progress().expect_same(s.motion.window, s.ordered);
    s.bodies.expect_all(s.motion.bodies);
    check_values(s.motion);
  });
  if (s.order == Kind::advance_mbd) s.link.progress().complete(s.ordered);
  return s.motion;
}

void Remote::control(const ControlSet& inputs) {
  State& s = *state_;
  s.link.vouch(Kind::control, [&] {
    s.link.progress().expect_now(inputs.time);
    check_values(inputs);
  });
  s.send(Kind::control, inputs);
  s.answer_nothing();
}

const BodiesFrame& Remote::observe_bodies(Nanoseconds now) {
  State& s = *state_;
  s.link.vouch(Kind::observe, [&] { s.link.progress().expect_now(now); });
  s.send(Kind::observe, now);
  s.answer();
  s.link.read(s.bodies_frame);
  s.link.check([&] {
    s.link.progress().expect_now(s.bodies_frame.time);
    check_values(s.bodies_frame);
  });
  return s.bodies_frame;
}

void Remote::start_advance(const MotionSet& motion) {
  State& s = *state_;
  s.link.vouch(Kind::advance_dem, [&] {
    s.link.progress().expect(motion.window);
    if (!s.bodies.known()) s.bodies.assign(motion.bodies);
    s.bodies.expect_all(motion.bodies);
    check_values(motion);
  });
  s.ordered = motion.window;
  s.send(Kind::advance_dem, motion);
}

const LoadSet& Remote::finish_load() {
  State& s = *state_;
  s.answer();
  s.link.read(s.load);
  s.link.check([&] {
    s.link.progress().expect_same(s.load.window, s.ordered);
    s.bodies.expect_some(s.load.bodies);
    check_values(s.load);
    check_account(s.load);
  });
  s.link.progress().complete(s.ordered);
  return s.load;
}

const TangentSet& Remote::linearise() {
  State& s = *state_;
  s.send(Kind::linearise);
  s.answer();
  s.link.read(s.tangents);
  s.link.check([&] {
    s.link.progress().expect_now(s.tangents.time);
    if (s.bodies.known()) {  // else before the first window
      s.bodies.expect_some(s.tangents.bodies);
      s.bodies.expect_some(s.tangents.responses);
    }
    check_values(s.tangents);
  });
  return s.tangents;
}

const ParticlesFrame& Remote::observe_particles(Nanoseconds now) {
  observe_particles(now, state_->particles_frame);
  return state_->particles_frame;
}

void Remote::observe_particles(Nanoseconds time, ParticlesFrame& into) {
  receive_particles(time, state_->received_particles);
  state_->received_particles.read(into);
}

void Remote::receive_particles(Nanoseconds time, ReceivedParticles& into) {
  State& s = *state_;
  s.link.vouch(Kind::observe, [&] { s.link.progress().use_snapshot(time); });
  s.send(Kind::observe, time);
  s.answer();
  s.link.take(into.frame_);
  into.time_ = time;
  into.place_ = s.link.place();
}

void ReceivedParticles::read(ParticlesFrame& into) const {
  try {
    decode(payload_of(frame_), into);
    if (into.time != time_)
      throw ProtocolError(Violation::wrong_time, "time is " + std::to_string(into.time.count) +
                                                     " ns, asked was " + std::to_string(time_.count) + " ns");
    check_values(into);
  } catch (const ProtocolError& e) {
    throw ProtocolError(e.violation(), e.problem(), place_, e.hint());
  }
}

void Remote::snapshot(Nanoseconds now) {
  State& s = *state_;
  s.link.vouch(Kind::snapshot, [&] { s.link.progress().expect_now(now); });
  s.send(Kind::snapshot, now);
  s.answer_nothing();
  s.link.progress().take_snapshot();
}

void Remote::save() {
  State& s = *state_;
  s.send(Kind::save);
  s.answer_nothing();
  s.link.progress().save();
}

void Remote::restore() {
  State& s = *state_;
  Progress restored = s.link.progress();
  s.link.vouch(Kind::restore, [&] { restored.restore(); });
  s.send(Kind::restore);
  s.answer_nothing();
  s.link.progress() = restored;
}

void Remote::checkpoint(const Checkpoint& file) {
  State& s = *state_;
  s.link.vouch(Kind::checkpoint, [&] {
    check_values(file);
    s.link.progress().expect_now(file.time);
  });
  s.send(Kind::checkpoint, file);
  s.answer_nothing();
}

void Remote::resume(const Checkpoint& file) {
  State& s = *state_;
  Progress resumed = s.link.progress();
  s.link.vouch(Kind::resume, [&] {
    check_values(file);
    resumed.resume(file.window, file.time);
  });
  s.send(Kind::resume, file);
  s.answer_nothing();
  s.link.progress() = resumed;
}

Report Remote::finish() {
  State& s = *state_;
  s.send(Kind::finish);
  s.answer();
  Report report;
  s.link.read(report);
  return report;
}

void Remote::fail(const Error& error) noexcept {
  State& s = *state_;
  try {
    if (s.link.session().state() == SessionState::ended) return;
    // A peer that does not even accept this is lost anyway.
    s.link.send(Kind::failure, Failure{error.code(), error.problem(), error.where(), error.hint()},
                Clock::now() + std::chrono::milliseconds(200));
  } catch (const std::exception&) {
  }
}

void Remote::set_idle(std::function<void()> idle) {
  state_->idle = std::move(idle);
}
Role Remote::role() const {
  return state_->link.session().role();
}
bool Remote::can(Capability capability) const {
  return (state_->capabilities & capability) != 0;
}
const std::string& Remote::program() const {
  return state_->program;
}
bool Remote::peer_gone() noexcept {
  return state_->channel->peer_gone();
}
const std::string& Remote::peer() const {
  return state_->channel->peer();
}
double Remote::wait_seconds() const {
  return std::chrono::duration<double>(state_->link.waited()).count();
}
double Remote::exchange_seconds() const {
  return std::chrono::duration<double>(state_->link.exchanged()).count();
}
void Remote::set_patience(std::chrono::milliseconds patience) {
  state_->patience = patience;
}

}  // namespace tandem::protocol
