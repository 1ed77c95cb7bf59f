// Whole sessions: the frames of a coordinator to a server, and those of a server to its coordinator. Frames
// are damaged, omitted, repeated, exchanged and given another kind. In any case a solver must only receive
// windows that follow each other.
#include "protocol/participant/serve.hpp"

#include <cstring>
#include <optional>
#include <thread>

#include "protocol/codec.hpp"
#include "protocol/frame.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/registration.hpp"
#include "protocol/remote.hpp"
#include "protocol/session.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/script.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "tests/unit/protocol/toy_solvers.hpp"

namespace tandem::fuzz {
namespace session_part {

using namespace protocol;
using namespace std::chrono_literals;

// The order of calls that every solver may rely on.
class Order {
 public:
  void configure() {
    note(!configured_, "a solver is configured twice");
    configured_ = true;
  }
  void window(const Window& window) {
    note(configured_, "a solver gets a window before it is configured");
    note(window.begin == now_ && window.end > window.begin,
         "a solver gets a window that does not follow the last one");
  }
  void advance(const Window& to) { window(to), now_ = to.end; }
  void save() { saved_ = now_, has_saved_ = true; }
  void restore() {
    note(has_saved_, "a solver goes back to what it has not saved");
    now_ = saved_;
  }
  void resume(Nanoseconds now) { now_ = now; }
  const char* broken = nullptr;

 private:
  void note(bool holds, const char* sentence) {
    if (!holds && !broken) broken = sentence;
  }
  bool configured_ = false, has_saved_ = false;
  Nanoseconds now_, saved_;
};

template <class Toy>
class Watched : public Toy {
 public:
  Configured configure(const Configuration& c) override { return order.configure(), Toy::configure(c); }
  void save() override { order.save(), Toy::save(); }
  void restore() override { order.restore(), Toy::restore(); }
  void resume(const protocol::Checkpoint& c) override { order.resume(c.time), Toy::resume(c); }
  Order order;
};
class WatchedMotion : public Watched<protocol::test::ToyMotion> {
 public:
  const MotionSet& predict(const Window& w) override { return order.window(w), ToyMotion::predict(w); }
  const MotionSet& advance(const LoadSet& l) override {
    return order.advance(l.window), ToyMotion::advance(l);
  }
};
class WatchedLoad : public Watched<protocol::test::ToyLoad> {
 public:
  const LoadSet& advance(const MotionSet& m) override { return order.advance(m.window), ToyLoad::advance(m); }
};

// ---- the coordinator's part: each call at least once

Window window_of(std::uint64_t index) {
  return protocol::test::window(index);
}

std::vector<BodyMotion> start(Remote& remote, Role role) {
  remote.set_patience(5s);
  remote.register_peer(capabilities_of(role), 5s);
  return remote.configure({"{}", "fuzz.json", {}, {}, "cpu", 1}).boundary;
}

void drive_mbd(Remote& remote) {
  const std::vector<BodyMotion> boundary = start(remote, Role::mbd);
  remote.control({{0}, {1, 2}});
  LoadSet loads;
  for (std::uint64_t i = 0; i < 3; ++i) {
    remote.save();
    remote.start_predict(window_of(i));
    remote.finish_motion();
    remote.start_extrapolate(window_of(i));
    remote.finish_motion();
    loads.window = window_of(i);
    loads.account.micro_steps = 1;
    loads.account.micro_step = loads.window.length();
    loads.bodies.assign(1, {});
    loads.bodies[0].body = boundary.empty() ? ground.value : boundary[0].body;
    remote.start_advance(loads);
    remote.finish_motion();
    if (i != 1) continue;
    remote.restore();
    remote.start_advance(loads);
    remote.finish_motion();
  }
  remote.checkpoint({3, window_of(3).begin, "/nowhere/mbd.h5"});
  remote.observe_bodies(window_of(3).begin);
  remote.finish();
}

void drive_dem(Remote& remote) {
  start(remote, Role::dem);
  remote.resume({2, window_of(2).begin, "/nowhere/dem.h5"});
  MotionSet motion;
  for (std::uint64_t i = 2; i < 5; ++i) {
    motion.window = window_of(i);
    motion.bodies.assign(1, {});
    motion.bodies[0].body = protocol::test::toy_body;
    remote.save();
    remote.start_advance(motion);
    remote.finish_load();
    remote.linearise();
    if (i != 3) continue;
    remote.restore();
    remote.start_advance(motion);
    remote.finish_load();
  }
  remote.observe_particles(window_of(5).begin);
  remote.finish();
}

template <class Solver>
void record(Role role, void (*drive)(Remote&), unsigned to, unsigned from, std::vector<Bytes>& corpus) {
  Script said, answered;
  auto [ours, theirs] = create_inproc(name(role));
  TappedChannel server_end(std::move(theirs), said);
  std::thread server([&] {
    Solver solver;
    serve(server_end, solver, "toy");
  });
  {
    Remote remote(std::make_unique<TappedChannel>(std::move(ours), answered), role, {42, 0});
    drive(remote);
  }
  server.join();
  corpus.push_back(input_of(to, said));
  corpus.push_back(input_of(from, answered));
}

std::vector<Bytes> sessions(const std::filesystem::path&) {
  std::vector<Bytes> corpus;
  record<WatchedMotion>(Role::mbd, drive_mbd, to_mbd, from_mbd, corpus);
  record<WatchedLoad>(Role::dem, drive_dem, to_dem, from_dem, corpus);
  return corpus;
}

// ---- damage

void reorder(Random& random, Script& frames) {
  const std::size_t at = random.below(frames.size()), other = random.below(frames.size());
  FrameHeader header;
  switch (random.below(5)) {
    case 0:
      frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(at), Bytes(frames[other]));
      break;
    case 2:
      std::swap(frames[at], frames[other]);
      break;
    case 3:
      if (frames[at].size() < sizeof header) break;
      std::memcpy(&header, frames[at].data(), sizeof header);
      header.kind = all_kinds[random.below(all_kinds.size())];
      std::memcpy(frames[at].data(), &header, sizeof header);
      break;
    default:
      break;  // unchanged
  }
}

void number_anew(Script& frames) {
  std::uint64_t sequence = 0;
  for (Bytes& frame : frames) {
    ++sequence;
    if (frame.size() >= sizeof(FrameHeader))
      std::memcpy(frame.data() + offsetof(FrameHeader, sequence), &sequence, sizeof sequence);
    reseal(frame);
  }
}

Fate finish_session(Random& random, Bytes& input) {
  std::span<const std::byte> rest = input;
  const unsigned end = chosen(rest, ends);
  Script frames = frames_in(rest);
  if (random.one_in(8) || frames.empty()) return Fate::open;
  for (std::size_t changes = random.below(4); changes > 0 && !frames.empty(); --changes)
    reorder(random, frames);
  number_anew(frames);
  input = input_of(random.one_in(16) ? end ^ early : end, frames);
  return Fate::open;
}

// ---- the target

class SessionTarget : public Target {
 public:
  void run(std::span<const std::byte> input) override {
    const unsigned choice = chosen(input, ends), end = choice % early;
    auto channel = std::make_unique<ScriptChannel>(frames_in(input), choice >= early);
    if (end == to_mbd) return serve_one<WatchedMotion>(*channel);
    if (end == to_dem) return serve_one<WatchedLoad>(*channel);
    Remote remote(std::move(channel), end == from_mbd ? Role::mbd : Role::dem, {42, 0});
    (end == from_mbd ? drive_mbd : drive_dem)(remote);
  }

 private:
  template <class Solver>
  static void serve_one(ScriptChannel& channel) {
    Solver solver;
    const int status = serve(channel, solver, "toy");
    if (solver.order.broken) throw Finding(solver.order.broken);
    if (channel.failure) throw Error(*channel.failure);
    if (status != 0)
      throw Error(ErrorCode::protocol, "the server left with status " + std::to_string(status));
  }
};

}  // namespace session_part

TargetKind session_target() {
  using namespace session_part;
  return {
      .name = "session", .corpus = sessions, .make = make_target<SessionTarget>, .finish = finish_session};
}

}  // namespace tandem::fuzz
