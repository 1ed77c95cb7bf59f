#include "protocol/codec.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "allocations.hpp"
#include "protocol/frame.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol::test {
namespace {

Hello hello() {
  return {Role::dem, 0x1234, can_rollback | can_window_mean, 99, "dem_server 0.1.0", "host"};
}
Failure failure() {
  return {ErrorCode::numerics, "no convergence", "body 3", "smaller step"};
}
Configuration configuration() {
  Configuration c;
  c.scene_text = R"({"tandem": 1})";
  c.origin = "scene.json";
  c.meshes = {{"floor", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}}, {"", {}}};
  c.files = {{"filling", "x,y,z,r\n1,2,3,0.1\n"}};
  c.backend = "cpu";
  c.threads = 3;
  return c;
}
BodyMotion body_motion(std::uint32_t body) {
  BodyMotion m;
  m.body = body;
  m.begin_pose = {{1, 2, 3}, {1, 0, 0, 0}};
  m.end_pose = {{4, 5, 6}, {0, 1, 0, 0}};
  m.begin_twist = {{7, 8, 9}, {10, 11, 12}};
  m.end_twist = {{13, 14, 15}, {16, 17, 18}};
  m.begin_a = {19, 20, 21};
  m.end_alpha = {22, 23, 24};
  return m;
}
MotionSet motion_set(std::size_t bodies) {
  MotionSet set;
  set.window = {4, {5}, {6}};
  for (std::uint32_t i = 0; i < bodies; ++i) set.bodies.push_back(body_motion(i));
  return set;
}
LoadSet load_set(std::size_t bodies) {
  LoadSet set;
  set.window = {4, {5}, {6}};
  set.account.micro_steps = 10;
  set.account.momentum_end = {1, 2, 3};
  for (std::uint32_t i = 0; i < bodies; ++i) set.bodies.push_back({i, 0, {{1, 2, 3}, {4, 5, 6}}, {}, {}, 7});
  return set;
}
BodiesFrame bodies_frame() {
  return {{7}, {{1, 0, {{1, 2, 3}, {}}, {}}}, {{2, 0, 0.5, 0.25, {}}}, 3.5};
}
ParticlesFrame particles_frame() {
  return {{8}, {1, 4}, {1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, {6, 5, 4, 3, 2, 1}, {.1f, .2f}};
}

template <class T>
class Codec : public testing::Test {};

struct HelloCase {
  static auto value() { return hello(); }
};
struct FailureCase {
  static auto value() { return failure(); }
};
struct ConfigurationCase {
  static auto value() { return configuration(); }
};
struct ConfiguredCase {
  static Configured value() { return {{body_motion(2)}, R"({"a": 1})"}; }
};
struct WindowCase {
  static Window value() { return {1, {2}, {3}}; }
};
struct MotionCase {
  static auto value() { return motion_set(3); }
};
struct LoadCase {
  static auto value() { return load_set(2); }
};
struct ControlCase {
  static ControlSet value() { return {{5}, {1.5, -2}}; }
};
struct CheckpointCase {
  static Checkpoint value() { return {4, {5}, "/a/state.h5"}; }
};
struct TimeCase {
  static Nanoseconds value() { return {12}; }
};
struct BodiesCase {
  static auto value() { return bodies_frame(); }
};
struct ParticlesCase {
  static auto value() { return particles_frame(); }
};
struct ReportCase {
  static Report value() { return {"{}"}; }
};
using Cases =
    testing::Types<HelloCase, FailureCase, ConfigurationCase, ConfiguredCase, WindowCase, MotionCase,
                   LoadCase, ControlCase, CheckpointCase, TimeCase, BodiesCase, ParticlesCase, ReportCase>;
TYPED_TEST_SUITE(Codec, Cases);

template <class T>
std::optional<Violation> refusal(std::span<const std::byte> bytes) {
  T value{};
  try {
    decode(bytes, value);
  } catch (const ProtocolError& e) {
    return e.violation();
  }
  return std::nullopt;
}

TYPED_TEST(Codec, GoesThereAndBackToTheByte) {
  const auto value = TypeParam::value();
  Bytes bytes, again;
  encode(bytes, value);
  EXPECT_EQ(bytes.size() % 8, 0u);
  std::remove_const_t<decltype(value)> decoded{};
  decode(bytes, decoded);
  encode(again, decoded);
  EXPECT_EQ(bytes, again);
}

TYPED_TEST(Codec, EveryShorterPayloadIsRefused) {
  using Value = decltype(TypeParam::value());
  Bytes bytes;
  encode(bytes, TypeParam::value());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto violation = refusal<Value>(std::span(bytes).first(size));
    EXPECT_TRUE(violation == Violation::truncated || violation == Violation::count_too_large)
        << size << " bytes";
  }
}

TYPED_TEST(Codec, ALongerPayloadIsRefused) {
  using Value = decltype(TypeParam::value());
  Bytes bytes;
  encode(bytes, TypeParam::value());
  bytes.resize(bytes.size() + 8);
  EXPECT_EQ(refusal<Value>(bytes), Violation::trailing_bytes);
}

TYPED_TEST(Codec, NoDamagedWordIsReadOutOfBounds) {
  // Each word in turn becomes a huge number: counts are refused before anything is allocated, values are
  // not checked here.
  using Value = decltype(TypeParam::value());
  Bytes bytes;
  encode(bytes, TypeParam::value());
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8)
    for (const std::uint64_t huge : {~std::uint64_t{0}, std::uint64_t{1} << 61, std::uint64_t{1} << 32}) {
      Bytes bad = bytes;
      std::memcpy(bad.data() + at, &huge, 8);
      refusal<Value>(bad);
    }
}

// Elements are at the end of the frame: one that ends before them has none, as that of a participant of 1.3.
TEST(CodecValues, AFrameMayHaveElements) {
  BodiesFrame sent = bodies_frame();
  Bytes without, bytes;
  encode(without, sent);
  sent.elements = {1.5, 2.5, -3};
  encode(bytes, sent);
  BodiesFrame got, touching = bodies_frame();
  touching.contacts = {7, 8};  // without elements
  Bytes account;
  encode(account, touching);
  decode(account, got);
  EXPECT_TRUE(got.elements.empty());
  EXPECT_EQ(got.contacts, touching.contacts);
  decode(bytes, got);
  EXPECT_EQ(got.elements, sent.elements);
  EXPECT_EQ(got.energy, sent.energy);
  for (std::size_t size = without.size() + 1; size < bytes.size(); ++size)
    EXPECT_EQ(refusal<BodiesFrame>(std::span(bytes).first(size)),
              size < without.size() + 8 ? Violation::truncated : Violation::count_too_large)
        << size << " bytes";
  decode(without, got);
  EXPECT_TRUE(got.elements.empty());
  EXPECT_TRUE(got.contacts.empty());
}

// Responses are at the end: one of 1.4 sends none.
TEST(CodecValues, TangentsMayHaveResponses) {
  TangentSet sent{Nanoseconds{5}, {{.body = 2}}};
  Bytes without, bytes;
  encode(without, sent);
  EXPECT_EQ(without.size(), 16 + sizeof(BodyTangent));
  sent.responses = {{.body = 2, .time = 0.5, .impulse = {3}}};
  encode(bytes, sent);
  TangentSet got;
  decode(bytes, got);
  ASSERT_EQ(got.responses.size(), 1u);
  EXPECT_EQ(got.responses[0].time, 0.5);
  EXPECT_EQ(got.responses[0].impulse[0], 3);
  decode(without, got);
  EXPECT_TRUE(got.responses.empty());
}

TEST(CodecValues, ArriveInTheirFields) {
  Bytes bytes;
  encode(bytes, hello());
  Hello h;
  decode(bytes, h);
  EXPECT_EQ(h.role, Role::dem);
  EXPECT_EQ(h.layout_hash, 0x1234u);
  EXPECT_EQ(h.capabilities, can_rollback | can_window_mean);
  EXPECT_EQ(h.pid, 99);
  EXPECT_EQ(h.program, "dem_server 0.1.0");
  EXPECT_EQ(h.host, "host");

  encode(bytes, configuration());
  Configuration c;
  decode(bytes, c);
  EXPECT_EQ(c.scene_text, configuration().scene_text);
  ASSERT_EQ(c.meshes.size(), 2u);
  EXPECT_EQ(c.meshes[0].mesh.triangles[0][2], 2u);
  EXPECT_EQ(c.files[0].text, "x,y,z,r\n1,2,3,0.1\n");
  EXPECT_EQ(c.threads, 3u);

  encode(bytes, motion_set(2));
  MotionSet m;
  decode(bytes, m);
  EXPECT_EQ(m.window.index, 4u);
  ASSERT_EQ(m.bodies.size(), 2u);
  EXPECT_EQ(std::memcmp(&m.bodies[1], &motion_set(2).bodies[1], sizeof(BodyMotion)), 0);

  encode(bytes, failure());
  Failure f;
  decode(bytes, f);
  EXPECT_EQ(f.code, ErrorCode::numerics);
  EXPECT_EQ(f.hint, "smaller step");
}

TEST(CodecValues, ANumberThatDoesNotFitIsRefused) {
  Bytes bytes;
  encode(bytes, hello());
  const std::uint64_t role = (std::uint64_t{1} << 32) + 1;  // would be read as mbd
  std::memcpy(bytes.data(), &role, 8);
  EXPECT_EQ(refusal<Hello>(bytes), Violation::count_too_large);
}

TEST(CodecValues, NothingIsExactlyNothing) {
  EXPECT_NO_THROW(decode_nothing({}));
  EXPECT_THROW(decode_nothing(Bytes(1)), ProtocolError);
}

TEST(CodecValues, TheSteadyExchangeDoesNotAllocate) {
  Bytes bytes;
  MotionSet motion;
  LoadSet loads;
  Window window;
  const MotionSet sent_motion = motion_set(10);
  const LoadSet sent_loads = load_set(10);
  const auto exchange = [&] {
    encode(bytes, window);
    decode(bytes, window);
    encode(bytes, sent_motion);
    decode(bytes, motion);
    encode(bytes, sent_loads);
    decode(bytes, loads);
  };
  exchange();
  const std::size_t before = allocations();
  for (int i = 0; i < 100; ++i) exchange();
  EXPECT_EQ(allocations() - before, 0u);
}

TEST(ParticlesFrameSize, IsThatOfItsPayload) {
  for (const std::size_t n : {0u, 1u, 2u, 1001u}) {
    const ParticlesFrame frame{{1},
                               std::vector<std::uint32_t>(n),
                               std::vector<double>(3 * n),
                               std::vector<float>(3 * n),
                               std::vector<float>(3 * n),
                               std::vector<float>(n)};
    Bytes bytes;
    encode(bytes, frame);
    EXPECT_EQ(size_of_particles_frame(n), bytes.size()) << n << " spheres";
    ParticlesFrame with_contacts = frame;
    with_contacts.contacts.resize(ParticlesFrame::contact_values * n);
    bytes.clear();
    encode(bytes, with_contacts);
    EXPECT_EQ(size_of_particles_frame(n, true), bytes.size()) << n << " spheres";
    // The arrays at the end are told apart where the first is empty.
    ParticlesFrame with_walls = frame, read;
    with_walls.walls = {1, 2, 3, 4, 5, 6, 7};
    bytes.clear();
    encode(bytes, with_walls);
    decode(bytes, read);
    EXPECT_TRUE(read.contacts.empty() && read.of_bodies.empty());
    EXPECT_EQ(read.walls, with_walls.walls);
    with_walls.walls.clear();
    with_walls.of_bodies = {-1, 2, 3, 4, 5, 6, 7, 8};
    bytes.clear();
    encode(bytes, with_walls);
    decode(bytes, read);
    EXPECT_TRUE(read.contacts.empty() && read.walls.empty());
    EXPECT_EQ(read.of_bodies, with_walls.of_bodies);
  }
  EXPECT_LT(size_of_particles_frame(76'000'000), max_payload);
  EXPECT_GT(size_of_particles_frame(77'000'000), max_payload);
}

}  // namespace
}  // namespace tandem::protocol::test
