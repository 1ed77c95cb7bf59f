#include "tests/fuzz/targets/frames_of_messages.hpp"

#include "protocol/frame.hpp"
#include "protocol/layout.hpp"

namespace tandem::fuzz {
namespace messages_part {

using namespace protocol;

const Window window{7, {7'000'000}, {8'000'000}};

BodyMotion motion_of(std::uint32_t body) {
  BodyMotion motion;
  motion.body = body;
  motion.begin_pose = {{1, 2, 3}, exp({0, 0, .25})};
  motion.end_pose = {{1, 2, 3.5}, exp({0, 0, .5})};
  motion.begin_twist = {{0, 0, 1}, {0, 0, 2}};
  motion.end_twist = {{0, 0, 1.5}, {0, 0, 2.5}};
  motion.begin_a = motion.end_a = {0, 0, -9.81};
  motion.applied_impulse = {{1, 0, 0}, {0, 1, 0}};
  motion.applied_work = 0.25;
  return motion;
}

LoadSet load_set() {
  LoadSet loads;
  loads.window = window;
  loads.account.micro_steps = 10;
  loads.account.micro_step = 1e-4;
  loads.account.kinetic_energy = 3;
  for (const std::uint32_t body : {0u, 3u, ground.value}) {
    BodyLoad load;
    load.body = body;
    load.mean = load.end = {{0, 0, 9.81}, {.1, .2, .3}};
    load.work = -1;
    loads.bodies.push_back(load);
  }
  return loads;
}

ParticlesFrame particles() {
  ParticlesFrame frame;
  frame.time = {8'000'000};
  for (std::uint32_t id : {0u, 2u, 5u}) {
    frame.id.push_back(id);
    frame.position.insert(frame.position.end(), {.1 * id, .2, .3});
    frame.velocity.insert(frame.velocity.end(), {1, 2, 3});
    frame.spin.insert(frame.spin.end(), {0, 0, 1});
    frame.radius.push_back(.05f);
  }
  return frame;
}

class Frames {
 public:
  void add(Kind kind) {
    payload_.clear();
    seal_payload(kind);
  }
  template <class T>
  void add(Kind kind, const T& value) {
    encode(payload_, value);
    seal_payload(kind);
  }
  std::vector<protocol::Bytes> all;

 private:
  void seal_payload(Kind kind) {
    FrameHeader header;
    header.kind = kind;
    header.run_id = 42;
    header.window = window.index;
    header.sequence = all.size() + 1;
    seal(header, payload_);
    const auto head = std::as_bytes(std::span(&header, 1));
    protocol::Bytes frame(head.begin(), head.end());
    frame.insert(frame.end(), payload_.begin(), payload_.end());
    all.push_back(std::move(frame));
  }
  protocol::Bytes payload_;
};

}  // namespace messages_part

std::vector<protocol::Bytes> frames_of_messages() {
  using namespace messages_part;
  const std::vector<BodyMotion> motions{motion_of(0), motion_of(3)};
  const Failure failure{ErrorCode::numerics, "no convergence", "joint 'hinge'", "a shorter step"};
  Frames frames;
  frames.add(Kind::hello,
             Hello{Role::mbd, layout_hash, can_predict | can_rollback, 4711, "mbd_server 0.1.0", "nodeb"});
  frames.add(Kind::welcome);
  frames.add(Kind::refuse, failure);
  frames.add(Kind::configure, Configuration{R"({"tandem": "1.0"})",
                                            "scene.json",
                                            {{"wheel", box_mesh({1, 1, 1})}},
                                            {{"stones", "x,y,z\n1,2,3\n"}},
                                            "cpu",
                                            2});
  frames.add(Kind::configured, Configured{motions, R"({"dof": 2})"});
  for (const Kind kind : {Kind::predict, Kind::extrapolate}) frames.add(kind, window);
  for (const Kind kind : {Kind::advance_mbd, Kind::load}) frames.add(kind, load_set());
  for (const Kind kind : {Kind::motion, Kind::advance_dem}) frames.add(kind, MotionSet{window, motions});
  for (const Kind kind : {Kind::save, Kind::restore, Kind::done, Kind::finish, Kind::linearise})
    frames.add(kind);
  frames.add(Kind::observe, Nanoseconds{8'000'000});
  frames.add(Kind::snapshot, Nanoseconds{8'000'000});
  BodiesFrame bodies;
  bodies.time = {8'000'000};
  bodies.bodies = {{0, 0, {{1, 2, 3}, {}}, {}}, {3, 0, {{3, 2, 1}, {}}, {}}};
  bodies.joints = {{0, 0, .5, 1, {}}, {1, 5, 0, 0, {{1, 2, 3}, {4, 5, 6}}}};
  frames.add(Kind::bodies, bodies);
  frames.add(Kind::particles, particles());
  frames.add(Kind::report, Report{R"({"mbd_state_hash": "1"})"});
  frames.add(Kind::failure, failure);
  TangentSet tangents{{8'000'000}, {{}}};
  tangents.bodies[0].body = 3;
  tangents.bodies[0].stiffness[0] = 1e5;
  frames.add(Kind::tangents, tangents);
  frames.add(Kind::control, ControlSet{{8'000'000}, {1, -2, .5}});
  for (const Kind kind : {Kind::checkpoint, Kind::resume})
    frames.add(kind, protocol::Checkpoint{8, {8'000'000}, "/scratch/run/checkpoint/window_000008/mbd.h5"});
  return frames.all;
}

}  // namespace tandem::fuzz
