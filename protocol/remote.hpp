// The coordinator's end of one participant: the calls of the solver interface, executed over a channel. Each
// call sends one message, waits for its answer within `patience`, and checks frame, session and values; a
// failure message of the peer is thrown as the Error that the peer threw. start_* and finish_* split a call
// in two, so that the parallel scheme can keep both participants busy.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/messages.hpp"
#include "protocol/run_identity.hpp"

namespace tandem::protocol {

class FrameSink;  // recorder.hpp

// A frame of particles as it came. Its memory is kept from frame to frame.
class ReceivedParticles {
 public:
  // Decodes the frame and checks its values; in any thread.
  void read(ParticlesFrame& into) const;

 private:
  friend class Remote;
  std::vector<std::byte> frame_;
  Nanoseconds time_{};
  std::string place_;  // for errors
};

class Remote {
 public:
  Remote(std::unique_ptr<Channel> channel, Role role, RunIdentity identity, FrameSink* recorder = nullptr);
  ~Remote();

  Hello register_peer(std::uint64_t needed_capabilities, std::chrono::milliseconds patience);
  Configured configure(const Configuration& configuration);

  Role role() const;  // of the participant
  // Whether the peer has registered this capability.
  bool can(Capability capability) const;
  // The peer with its version, as it named itself at registration; empty before.
  const std::string& program() const;

  // mbd
  void start_predict(const Window& window);
  void start_extrapolate(const Window& window);
  void start_advance(const LoadSet& loads);
  const MotionSet& finish_motion();
  void control(const ControlSet& inputs);
  const BodiesFrame& observe_bodies(Nanoseconds now);
  // load solvers
  void start_advance(const MotionSet& motion);
  const LoadSet& finish_load();
  const ParticlesFrame& observe_particles(Nanoseconds now);
  // `time`: now, or that of the last snapshot, whose frame is sent once.
  void observe_particles(Nanoseconds time, ParticlesFrame& into);
  // The same, but not yet decoded.
  void receive_particles(Nanoseconds time, ReceivedParticles& into);
  // can_snapshot: the participant keeps the present frame, and prepares it while the next window is computed.
  void snapshot(Nanoseconds now);
  // both
  const TangentSet& linearise();
  void save();
  void restore();
  // The participant writes its state to this file on its host, or restores its state from it.
  void checkpoint(const Checkpoint& file);
  void resume(const Checkpoint& file);
  Report finish();
  // Reports to the peer that the run ends because of `error`; never throws.
  void fail(const Error& error) noexcept;

  // Called about every 50 ms while this end waits for an answer; an exception from it ends the wait. It is
  // used for Ctrl-C and for checking the other peer.
  void set_idle(std::function<void()> idle);
  // Whether the peer is known to be dead or to have closed its end; any thread.
  bool peer_gone() noexcept;

  const std::string& peer() const;
  double wait_seconds() const;                            // time spent waiting for this peer's answers [s]
  double exchange_seconds() const;                        // time spent in encoding, decoding and copying [s]
  void set_patience(std::chrono::milliseconds patience);  // limit of one wait, default 60 s

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tandem::protocol
