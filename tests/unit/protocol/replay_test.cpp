// Recordings of sessions with toy solvers, and their replay: equal, or the first difference by name.
#include "protocol/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "protocol/difference.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/last_frames.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/remote.hpp"
#include "toy_solvers.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Optional;

constexpr Role role_of(const MotionSolver&) {
  return Role::mbd;
}
constexpr Role role_of(const LoadSolver&) {
  return Role::dem;
}

class Replayed : public testing::Test {
 protected:
  ~Replayed() override { std::filesystem::remove(file); }

  // A run of toy solvers; `end` is called with both ends after the last window.
  static void record(FrameSink& sink, std::uint64_t windows, ToyMotion& motion,
                     const std::function<void(Remote&, Remote&)>& end) {
    auto [mbd_end, mbd_server] = create_inproc("mbd_server");
    auto [dem_end, dem_server] = create_inproc("dem_server");
    ToyLoad load;
    std::jthread first([&motion, server = std::move(mbd_server)]() mutable {
      serve(*server, motion, "toy 1");
      server.reset();
    });
    std::jthread second([&load, server = std::move(dem_server)]() mutable {
      serve(*server, load, "toy 1");
      server.reset();
    });
    Remote mbd(std::move(mbd_end), Role::mbd, {77, 3}, &sink);
    Remote dem(std::move(dem_end), Role::dem, {77, 3}, &sink);
    for (Remote* remote : {&mbd, &dem}) {
      remote->set_patience(5s);
      remote->register_peer(0, 5s);
      remote->configure({});
    }
    // The first window is repeated.
    mbd.save();
    dem.save();
    for (std::uint64_t i = 0; i < windows; ++i) {
      for (int iteration = 0; iteration < (i == 0 ? 2 : 1); ++iteration) {
        if (iteration > 0) {
          mbd.restore();
          dem.restore();
        }
        mbd.start_predict(window(i));
        dem.start_advance(mbd.finish_motion());
        mbd.start_advance(dem.finish_load());
        mbd.finish_motion();
      }
      mbd.observe_bodies(window(i).end);
      dem.observe_particles(window(i).end);
    }
    end(mbd, dem);
  }
  void record(std::uint64_t windows) {
    Recorder recorder(file);
    ToyMotion motion;
    record(recorder, windows, motion, [&](Remote& mbd, Remote& dem) {
      mbd.checkpoint({windows, window(windows - 1).end, "/a/state.h5"});
      mbd.finish();
      dem.finish();
    });
  }

  ReplayResult replay(auto& solver) {
    const Replay recording(file, role_of(solver));
    auto [end, theirs] = create_inproc(name(role_of(solver)));
    std::jthread thread([&solver, server = std::move(theirs)]() mutable {
      serve(*server, solver, "toy 2");
      server.reset();
    });
    const auto own = std::move(end);  // closed before the thread is waited for
    return recording.against(*own, 5s);
  }
  std::string refusal(Role role) {
    try {
      const Replay recording(file, role);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage);
      return e.what();
    }
    return "nothing was thrown";
  }

  std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("tandem_replay_" + std::to_string(getpid()) + ".rec");
};

TEST_F(Replayed, BothRolesAreEqualToTheBit) {
  record(20);
  ToyMotion motion;
  const ReplayResult mbd = replay(motion);
  EXPECT_EQ(mbd.difference, std::nullopt);
  EXPECT_EQ(mbd.compared, 1u + 2 * 21 + 20);
  EXPECT_EQ(mbd.windows, 20u);
  EXPECT_EQ(mbd.not_repeated, 1u) << "the restart file of the run must stay";
  EXPECT_EQ(motion.written.path, "");
  EXPECT_EQ(mbd.ending, std::nullopt);
  ToyLoad load;
  const ReplayResult dem = replay(load);
  EXPECT_EQ(dem.difference, std::nullopt);
  EXPECT_EQ(dem.compared, 1u + 21 + 20);
}

class Heavier : public ToyMotion {
 public:
  const MotionSet& predict(const Window& w) override {
    motion_ = ToyMotion::predict(w);
    if (w.index == 3) motion_.bodies[0].end_pose.p_WB.z += 0.25;
    return motion_;
  }
  MotionSet motion_;
};

TEST_F(Replayed, TheFirstDifferenceIsNamed) {
  record(20);
  Heavier heavier;
  const ReplayResult result = replay(heavier);
  EXPECT_THAT(
      result.difference,
      Optional(AllOf(HasSubstr("motion of window 3, BodyMotion of body 3: end_pose.p_WB.z: replayed "),
                     HasSubstr(", recorded "), HasSubstr(", difference 0.25"))));
  EXPECT_EQ(result.compared, 1u + 2 * 4 + 3) << "the rest is not replayed";
}

class Failing : public ToyMotion {
 public:
  const MotionSet& advance(const LoadSet& loads) override {
    if (loads.window.index == 2) throw Error(ErrorCode::numerics, reason, "toy");
    return ToyMotion::advance(loads);
  }
  std::string reason = "does not converge";
};

TEST_F(Replayed, AFailureIsADifferenceUnlessItIsTheRecordedOne) {
  record(4);
  Failing failing;
  EXPECT_THAT(replay(failing).difference,
              Optional(HasSubstr("instead of motion of window 2 it failed: toy: does not converge")));
  {
    Recorder recorder(file);
    Failing recorded;
    EXPECT_THROW(record(recorder, 4, recorded, {}), Error);
  }
  Failing again;
  const ReplayResult same = replay(again);
  EXPECT_EQ(same.difference, std::nullopt);
  EXPECT_THAT(same.ending, Optional(HasSubstr("both fail: toy: does not converge")));
  Failing other;
  other.reason = "is not a number";
  EXPECT_THAT(replay(other).difference,
              Optional(AllOf(HasSubstr("what: replayed 'is not a number', recorded 'does not converge'"))));
  ToyMotion healthy;
  EXPECT_THAT(replay(healthy).difference,
              Optional(HasSubstr("(toy: does not converge) it answered motion of window 2")));
}

TEST_F(Replayed, AnEndByTheCoordinatorIsSaid) {
  {
    Recorder recorder(file);
    ToyMotion motion;
    record(recorder, 2, motion, [](Remote& mbd, Remote& dem) {
      mbd.start_predict(window(2));
      for (Remote* remote : {&mbd, &dem}) remote->fail(Error(ErrorCode::peer_lost, "dem_server is gone"));
    });
  }
  ToyMotion motion;
  const ReplayResult result = replay(motion);
  EXPECT_EQ(result.difference, std::nullopt);
  EXPECT_THAT(result.ending,
              Optional(AllOf(HasSubstr("no answer to predict of window 2"), HasSubstr("dem_server is gone"),
                             HasSubstr("here it answers motion"))));
}

TEST_F(Replayed, ARecordingThatIsCutEndsThere) {
  record(4);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  ToyMotion motion;
  const ReplayResult result = replay(motion);
  EXPECT_EQ(result.difference, std::nullopt);
  EXPECT_THAT(result.ending, Optional(HasSubstr("the recording ends here")));
}

TEST_F(Replayed, LastFramesOfAShortRunReplayAndOfALongOneSayWhatIsMissing) {
  ToyMotion motion;
  const auto finish = [](Remote& mbd, Remote& dem) {
    mbd.finish();
    dem.finish();
  };
  LastFrames all;
  record(all, 5, motion, finish);
  all.write(file);
  ToyLoad load;
  EXPECT_EQ(replay(load).difference, std::nullopt);
  LastFrames some(16 << 10);
  ToyMotion again;
  record(some, 100, again, finish);
  some.write(file);
  EXPECT_THAT(refusal(Role::mbd), AllOf(HasSubstr("windows 0 to "), HasSubstr("are missing"),
                                        HasSubstr("tandem run --record FILE")));
}

// Of an answer that was too large, the order is repeated all the same.
TEST_F(Replayed, AnAnswerThatWasNotKeptIsNotCompared) {
  record(3);
  std::vector<RecordedFrame> frames;
  {
    RecordingReader reader(file);
    for (RecordedFrame frame; reader.next(frame);) frames.push_back(frame);
  }
  {
    RecordingWriter writer(file);
    for (const RecordedFrame& frame : frames) {
      std::span<const std::byte> bytes = frame.frame;
      if (frame.header.kind == Kind::particles) bytes = bytes.first(sizeof(FrameHeader));
      writer.write(frame.time, frame.direction, frame.role, std::span(&bytes, 1));
    }
  }
  ToyLoad load;
  const ReplayResult result = replay(load);
  EXPECT_EQ(result.difference, std::nullopt);
  EXPECT_EQ(result.not_kept, 3u);
  EXPECT_EQ(result.compared, 1u + 4);
}

void overwrite(const std::filesystem::path& file, std::streamoff at, std::uint64_t word,
               std::streamsize size) {
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
      .seekp(at)
      .write(reinterpret_cast<const char*>(&word), size);
}

TEST_F(Replayed, OlderFilesAndOlderDialectsAreRead) {
  record(3);
  overwrite(file, 7, '1', 1);
  overwrite(file, 8, dialects[1].layout_hash, 8);
  ToyMotion motion;
  EXPECT_EQ(replay(motion).difference, std::nullopt);
}

TEST_F(Replayed, WhatCannotBeReplayedIsRefused) {
  record(3);
  overwrite(file, 8, 12345, 8);
  EXPECT_THAT(refusal(Role::mbd),
              HasSubstr("another layout of the protocol than those of versions 1.5, 1.4 and 1.3"));
  record(3);
  overwrite(file, 7, '3', 1);
  EXPECT_THAT(refusal(Role::mbd), HasSubstr("is no recording"));
  std::filesystem::remove(file);
  { Recorder recorder(file); }
  EXPECT_THAT(refusal(Role::mbd), HasSubstr("has no frames of mbd_server"));
  record(3);
  overwrite(file, 16 + 24 + 64 + 8, 12345, 8);
  ToyMotion motion;
  EXPECT_THROW(replay(motion), Error) << "the checksum of a frame is wrong";
}

// Without the capability there would be no answer to compare.
class Simple final : public MotionSolver {
 public:
  std::uint64_t capabilities() const override { return 0; }
  Configured configure(const Configuration&) override { return {}; }
  const MotionSet& advance(const LoadSet&) override { return motion_; }
  const BodiesFrame& observe() override { return frame_; }
  Report report() override { return {"{}"}; }

 private:
  MotionSet motion_;
  BodiesFrame frame_;
};

TEST_F(Replayed, AParticipantThatLacksACapabilityIsRefused) {
  record(3);
  Simple simple;
  try {
    replay(simple);
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::protocol);
    EXPECT_THAT(e.what(), HasSubstr("missing can_predict, can_rollback"));
  }
}

TEST(Difference, EachKindOfFieldIsNamed) {
  const auto place = [](Kind kind, const auto& replayed, const auto& recorded) {
    Bytes a, b;
    encode(a, replayed);
    encode(b, recorded);
    const auto found = first_difference(kind, a, b);
    return found
               ? found->place + " | " + found->replayed + " | " + found->recorded + " | " + found->difference
               : "equal";
  };
  LoadSet load;
  load.bodies.resize(2);
  load.bodies[0].body = ground.value;
  load.bodies[1].body = 4;
  LoadSet other = load;
  EXPECT_EQ(place(Kind::load, other, load), "equal");
  other.bodies[1].first_moment.torque.y = 2;
  EXPECT_EQ(place(Kind::load, other, load), "BodyLoad of body 4: first_moment.torque.y | 2 | 0 | 2");
  other.bodies[0].work = -0.0;
  EXPECT_EQ(place(Kind::load, other, load), "BodyLoad of the ground: work | -0 | 0 | -0");
  other = load;
  other.account.contacts = 3;
  load.account.contacts = 5;
  EXPECT_EQ(place(Kind::load, other, load), "ParticleAccount: contacts | 3 | 5 | -2");
  other.bodies.pop_back();
  EXPECT_EQ(place(Kind::load, other, load), "number of bodies | 1 | 2 | -1");

  TangentSet tangents;
  tangents.bodies.resize(1);
  TangentSet stiffer = tangents;
  stiffer.bodies[0].damping[8] = 1;
  EXPECT_EQ(place(Kind::tangents, stiffer, tangents), "BodyTangent of body 0: damping[1][2] | 1 | 0 | 1");

  BodiesFrame bodies;
  bodies.joints.resize(1);
  bodies.joints[0].joint = 6;
  BodiesFrame turned = bodies;
  turned.time = {5};
  EXPECT_EQ(place(Kind::bodies, turned, bodies), "time | 5 ns | 0 ns | 5 ns");
  turned = bodies;
  turned.joints[0].q = 0.5;
  EXPECT_EQ(place(Kind::bodies, turned, bodies), "JointState of joint 6: q | 0.5 | 0 | 0.5");
  BodiesFrame driven = bodies, other_driven = bodies;
  driven.elements = {1, 2}, other_driven.elements = {1, 3};
  EXPECT_EQ(place(Kind::bodies, other_driven, driven), "element column 1 | 3 | 2 | 1");
  EXPECT_EQ(place(Kind::bodies, bodies, driven), "number of element columns | 0 | 2 | -2");
  driven.contacts = {3}, other_driven = driven, other_driven.contacts = {4};
  EXPECT_EQ(place(Kind::bodies, other_driven, driven), "account of contacts 0 | 4 | 3 | 1");

  ParticlesFrame spheres{{},    {7, 9}, std::vector<double>(6), std::vector<float>(6), std::vector<float>(6),
                         {1, 1}};
  ParticlesFrame moved = spheres;
  moved.velocity[5] = 0.5f;
  EXPECT_EQ(place(Kind::particles, moved, spheres), "sphere 9: velocity.z | 0.5 | 0 | 0.5");
  moved.id[1] = 8;
  EXPECT_EQ(place(Kind::particles, moved, spheres), "sphere 9: id | 8 | 9 | -1");
  ParticlesFrame liquid = spheres;
  liquid.liquid = {100, 1000, 200, 1001};
  ParticlesFrame denser = liquid;
  denser.liquid[3] = 1002;
  EXPECT_EQ(place(Kind::particles, denser, liquid), "particle 9: density | 1002 | 1001 | 1");
  denser.liquid[2] = 150;
  EXPECT_EQ(place(Kind::particles, denser, liquid), "particle 9: pressure | 150 | 200 | -50");
  EXPECT_EQ(place(Kind::particles, spheres, liquid), "number of values of the liquid | 0 | 4 | -4");

  Configured configured{{}, R"({"device": "here"})"}, there{{}, R"({"device": "there"})"};
  EXPECT_EQ(place(Kind::configured, configured, there), "equal") << "facts are about the machine";
}

}  // namespace
}  // namespace tandem::protocol::test
