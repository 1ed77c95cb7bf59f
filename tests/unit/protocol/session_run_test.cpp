// Whole sessions: Remote at one end, serve() with a toy solver in a thread at the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <future>
#include <thread>

#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/link.hpp"
#include "protocol/participant/serve.hpp"
#include "protocol/recorder.hpp"
#include "protocol/registration.hpp"
#include "protocol/remote.hpp"
#include "toy_solvers.hpp"

namespace tandem::protocol::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr RunIdentity run_identity{0xabcdef, 2};

// A participant in a thread of its own.
template <class Solver>
struct Participant {
  explicit Participant(const std::string& name, Recorder* recorder = nullptr) {
    auto [coordinator, participant] = create_inproc(name);
    remote = std::make_unique<Remote>(std::move(coordinator),
                                      std::is_base_of_v<MotionSolver, Solver> ? Role::mbd : Role::dem,
                                      run_identity, recorder);
    remote->set_patience(5s);
    thread = std::jthread([this, end = std::move(participant)]() mutable {
      status = serve(*end, solver, "toy 1");
      end.reset();  // like a process that ends
    });
  }
  ~Participant() { remote.reset(); }  // otherwise a participant that still receives would be waited for
  int leave() {
    thread.join();
    return status;
  }
  Solver solver;
  std::unique_ptr<Remote> remote;
  int status = -1;
  std::jthread thread;
};

Error error_of(auto&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorCode::internal, ""};
}

void start(Remote& remote) {
  remote.register_peer(can_rollback, 5s);
  remote.configure({});
}

// Its failure counts, although it does not know the run yet.
TEST(SessionRun, AFailureBeforeTheWelcomeIsTold) {
  auto [coordinator, participant] = create_inproc("mbd_server");
  Remote remote(std::move(coordinator), Role::mbd, run_identity);
  remote.set_patience(5s);
  Link link(*participant, Role::mbd, Sender::participant);
  const auto in_time = [] { return Clock::now() + 5s; };
  link.send(Kind::hello, Hello{Role::mbd, layout_hash, capabilities_of(Role::mbd), 1, "toy 1", "here"},
            in_time());
  remote.register_peer(0, 5s);
  link.send(Kind::failure, Failure{ErrorCode::resource, "the licence has expired", "toy", "renew it"},
            in_time());
  const Error error = error_of([&] { remote.configure({}); });
  EXPECT_EQ(error.code(), ErrorCode::resource);
  EXPECT_STREQ(error.what(), "toy: the licence has expired (renew it)");
}

TEST(SessionRun, TheThreeSchemesAndAWholeLife) {
  Participant<ToyMotion> mbd("mbd_server");
  Participant<ToyLoad> dem("dem_server");
  const Hello hello = mbd.remote->register_peer(can_predict | can_rollback, 5s);
  EXPECT_EQ(hello.program, "toy 1");
  EXPECT_EQ(hello.role, Role::mbd);
  dem.remote->register_peer(can_interpolate, 5s);
  const Configured boundary = mbd.remote->configure({});
  ASSERT_EQ(boundary.boundary.size(), 1u);
  EXPECT_EQ(boundary.boundary[0].body, toy_body);
  EXPECT_EQ(dem.remote->configure({}).facts, R"({"backend": "toy"})");

  // dem_first, with one window repeated
  mbd.remote->save();
  dem.remote->save();
  double height[2];
  for (double& h : height) {
    mbd.remote->start_predict(window(0));
    dem.remote->start_advance(mbd.remote->finish_motion());
    mbd.remote->start_advance(dem.remote->finish_load());
    h = mbd.remote->finish_motion().bodies[0].end_pose.p_WB.z;
    if (&h == height) {
      mbd.remote->restore();
      dem.remote->restore();
    }
  }
  EXPECT_EQ(height[0], height[1]);
  EXPECT_NE(height[0], 1);
  // mbd_first
  LoadSet last;
  last.window = window(1);
  mbd.remote->start_advance(last);
  dem.remote->start_advance(mbd.remote->finish_motion());
  last = dem.remote->finish_load();
  // parallel
  mbd.remote->start_predict(window(2));
  MotionSet motion = mbd.remote->finish_motion();
  last.window = window(2);
  dem.remote->start_advance(motion);
  mbd.remote->start_advance(last);
  dem.remote->finish_load();
  mbd.remote->finish_motion();

  EXPECT_EQ(mbd.remote->observe_bodies({3'000'000}).bodies[0].body, toy_body);
  EXPECT_EQ(dem.remote->observe_particles({3'000'000}).id.size(), 2u);
  EXPECT_EQ(mbd.remote->finish().facts, R"({"windows": 1})");
  EXPECT_EQ(dem.remote->finish().facts, R"({"state_hash": "0"})");
  EXPECT_EQ(mbd.leave(), 0);
  EXPECT_EQ(dem.leave(), 0);
  EXPECT_GT(mbd.remote->exchange_seconds(), 0);
}

TEST(SessionRun, ControlInputsReachTheSolver) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  EXPECT_TRUE(mbd.remote->can(can_control));
  mbd.remote->control({{0}, {1.5, -2}});
  EXPECT_EQ(mbd.solver.inputs, (std::vector<double>{1.5, -2}));
  const Error late = error_of([&] { mbd.remote->control({{1'000'000}, {0, 0}}); });
  EXPECT_EQ(late.code(), ErrorCode::protocol);
  EXPECT_THAT(late.what(), HasSubstr("control"));
  mbd.remote->finish();
}

TEST(SessionRun, StatesOnDiskCarryWindowAndTime) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  EXPECT_TRUE(mbd.remote->can(can_checkpoint));
  EXPECT_EQ(error_of([&] { mbd.remote->checkpoint({0, {1}, "/a/state.h5"}); }).code(), ErrorCode::protocol);
  mbd.remote->resume({2, {2'000'000}, "/a/state.h5"});
  EXPECT_EQ(mbd.remote->observe_bodies({2'000'000}).bodies[0].pose.p_WB.z, 0.25);
  mbd.remote->start_predict(window(2));
  mbd.remote->finish_motion();
  LoadSet loads;
  loads.window = window(2);
  mbd.remote->start_advance(loads);
  mbd.remote->finish_motion();
  mbd.remote->checkpoint({3, {3'000'000}, "/a/state.h5"});
  EXPECT_EQ(mbd.solver.written.path, "/a/state.h5");
  const Error late = error_of([&] { mbd.remote->resume({2, {2'000'000}, "/a/state.h5"}); });
  EXPECT_THAT(late.what(), HasSubstr("resume comes after window 2"));
  mbd.remote->finish();
}

TEST(SessionRun, AnErrorOfTheSolverComesOutAtTheCoordinator) {
  Participant<ToyMotion> mbd("mbd_server");
  mbd.remote->register_peer(0, 5s);
  Configuration configuration;
  configuration.scene_text = "bad scene";
  const Error e = error_of([&] { mbd.remote->configure(configuration); });
  EXPECT_EQ(e.code(), ErrorCode::scene);
  EXPECT_STREQ(e.what(), "toy.json: no bodies (add one)");
  EXPECT_EQ(mbd.leave(), exit_status(ErrorCode::scene));
}

TEST(SessionRun, AnErrorOfTheCoordinatorEndsTheParticipant) {
  Participant<ToyLoad> dem("dem_server");
  start(*dem.remote);
  dem.remote->fail(Error(ErrorCode::interrupted, "interrupted by the user"));
  EXPECT_EQ(dem.leave(), exit_status(ErrorCode::interrupted));
}

// A coordinator ends the run while the solver works: its reason counts, not the loss of the connection.
TEST(SessionRun, TheReasonForTheEndIsHeardAfterTheWork) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  std::promise<void> working, left;
  mbd.solver.at_work = [&] {
    working.set_value();
    left.get_future().wait();
  };
  mbd.remote->start_predict(window(0));
  working.get_future().wait();
  mbd.remote->fail(Error(ErrorCode::interrupted, "interrupted by the user"));
  mbd.remote.reset();
  left.set_value();
  EXPECT_EQ(mbd.leave(), exit_status(ErrorCode::interrupted));
}

TEST(SessionRun, AMissingCapabilityIsRefusedOnBothSides) {
  Participant<ToyLoad> dem("dem_server");
  const Error e = error_of([&] { dem.remote->register_peer(can_predict, 5s); });
  EXPECT_EQ(e.code(), ErrorCode::protocol);
  EXPECT_THAT(e.what(), AllOf(HasSubstr("dem_server"), HasSubstr("missing can_predict")));
  EXPECT_EQ(dem.leave(), exit_status(ErrorCode::protocol));
}

// Steps forward only: what a solver without rollback implements.
class ForwardOnly final : public MotionSolver {
 public:
  std::uint64_t capabilities() const override { return can_predict; }
  Configured configure(const Configuration&) override { return {{}, "{}"}; }
  const MotionSet& predict(const Window& window) override { return moved(window); }
  const MotionSet& advance(const LoadSet& loads) override { return moved(loads.window); }
  const BodiesFrame& observe() override { return frame_; }
  Report report() override { return {"{}"}; }

 private:
  const MotionSet& moved(const Window& window) {
    motion_.window = window;
    return motion_;
  }
  MotionSet motion_;
  BodiesFrame frame_;
};

TEST(SessionRun, ASolverMayLackRollback) {
  Participant<ForwardOnly> mbd("mbd_server");
  EXPECT_EQ(mbd.remote->register_peer(can_predict, 5s).capabilities, std::uint64_t{can_predict});
  EXPECT_FALSE(mbd.remote->can(can_rollback));
  mbd.remote->configure({});
  EXPECT_THAT(error_of([&] { mbd.remote->save(); }).what(), HasSubstr("cannot save its state"));
  EXPECT_EQ(mbd.leave(), exit_status(ErrorCode::protocol));
}

TEST(SessionRun, AParticipantThatClosesIsLostInItsWindow) {
  auto [end, other] = create_inproc("mbd_server");
  Remote remote(std::move(end), Role::mbd, run_identity);
  other.reset();
  const Error e = error_of([&] { remote.register_peer(0, 5s); });
  EXPECT_EQ(e.code(), ErrorCode::peer_lost);
  EXPECT_THAT(e.what(), HasSubstr("mbd_server closed its end in window 0, before hello"));
}

TEST(SessionRun, ACoordinatorThatClosesEndsTheParticipant) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  mbd.remote.reset();
  EXPECT_EQ(mbd.leave(), exit_status(ErrorCode::peer_lost));
}

TEST(SessionRun, ASilentParticipantIsATimeout) {
  auto [end, other] = create_inproc("dem_server");
  Remote remote(std::move(end), Role::dem, run_identity);
  const Error e = error_of([&] { remote.register_peer(0, 80ms); });
  EXPECT_EQ(e.code(), ErrorCode::timeout);
  EXPECT_THAT(e.what(), AllOf(HasSubstr("dem_server"), HasSubstr("hello")));
}

TEST(SessionRun, IdleIsCalledWhileWaitingAndMayEndTheWait) {
  auto [end, other] = create_inproc("dem_server");
  Remote remote(std::move(end), Role::dem, run_identity);
  remote.set_idle([] { throw Error(ErrorCode::interrupted, "Ctrl-C"); });
  EXPECT_EQ(error_of([&] { remote.register_peer(0, 60s); }).code(), ErrorCode::interrupted);
}

struct SpoiledCase {
  ToyMotion::Spoil spoil;
  ErrorCode code;
  const char* text;
};

class Spoiled : public testing::TestWithParam<SpoiledCase> {};

TEST_P(Spoiled, AnswerIsRefusedByItsSenderAndNamed) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  mbd.solver.spoil = GetParam().spoil;
  mbd.remote->start_predict(window(0));
  const Error e = error_of([&] { mbd.remote->finish_motion(); });
  EXPECT_EQ(e.code(), GetParam().code);
  EXPECT_THAT(e.what(), AllOf(HasSubstr("motion of window 0 from mbd_server"), HasSubstr(GetParam().text)));
  EXPECT_EQ(mbd.leave(), exit_status(GetParam().code));
}

INSTANTIATE_TEST_SUITE_P(Values, Spoiled,
                         testing::Values(SpoiledCase{ToyMotion::Spoil::nan, ErrorCode::numerics,
                                                     "body 3: end_twist.v_WB is (0, nan, 0), not finite"},
                                         SpoiledCase{ToyMotion::Spoil::quaternion, ErrorCode::protocol,
                                                     "body 3: end_pose.q_WB has the norm 1.0009999"},
                                         SpoiledCase{ToyMotion::Spoil::unknown_body, ErrorCode::protocol,
                                                     "body 7 is not one of the 1 boundary bodies"},
                                         SpoiledCase{ToyMotion::Spoil::wrong_window, ErrorCode::protocol,
                                                     "window.index is 1, ordered was 0"}));

TEST(SessionRun, TheCoordinatorsOwnMistakesAreNamedBeforeTheyAreSent) {
  Participant<ToyMotion> mbd("mbd_server");
  start(*mbd.remote);
  EXPECT_THAT(error_of([&] { mbd.remote->start_predict(window(4)); }).what(),
              HasSubstr("predict of window 0 to mbd_server: window.index is 4, expected 0"));
  EXPECT_THAT(error_of([&] {
                mbd.remote->start_predict({0, {0}, {0}});
              }).what(),
              HasSubstr("not after window.begin"));
  LoadSet loads;
  loads.window = window(0);
  loads.bodies.resize(1);
  loads.bodies[0].body = 1;
  EXPECT_THAT(error_of([&] { mbd.remote->start_advance(loads); }).what(), HasSubstr("body 1 is not one of"));
  EXPECT_THAT(error_of([&] { mbd.remote->restore(); }).what(),
              HasSubstr("restore comes before the first save"));
}

// An earlier recording is replaced; any other file would be lost.
TEST(SessionRun, ARecordingOverwritesNothingElse) {
  const auto file = std::filesystem::temp_directory_path() / ("tandem_mine_" + std::to_string(getpid()));
  for (const std::string content : {"my thesis, chapter 1", "TNDM"}) {
    std::ofstream(file, std::ios::binary) << content;
    EXPECT_THAT(error_of([&] { Recorder recorder(file); }).what(),
                HasSubstr("is there, and is no recording: it would be overwritten"));
    std::ostringstream left;
    left << std::ifstream(file).rdbuf();
    EXPECT_EQ(left.str(), content);
  }
  EXPECT_THAT(error_of([] { Recorder recorder("/dev/null"); }).what(), HasSubstr("is a device"));
  std::ofstream(file, std::ios::trunc).close();
  for (int i = 0; i < 2; ++i) Recorder recorder(file);
  std::filesystem::remove(file);
}

// Memory is not allocated for a size in a damaged file.
TEST(SessionRun, ARecordingThatEndsInAFrameTakesNoMemoryForTheRest) {
  const auto file = std::filesystem::temp_directory_path() / ("tandem_cut_" + std::to_string(getpid()));
  {
    Recorder recorder(file);
    const FrameHeader header;
    for (int i = 0; i < 2; ++i)
      recorder.record(Direction::to_participant, Role::mbd, std::as_bytes(std::span(&header, 1)), {});
  }
  constexpr std::uint64_t head = 16, record = 24 + sizeof(FrameHeader), size_at = head + record + 16,
                          announced = 4'000'000'000;
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
      .seekp(size_at)
      .write(reinterpret_cast<const char*>(&announced), sizeof announced);
  RecordingReader reader(file);
  RecordedFrame frame;
  EXPECT_TRUE(reader.next(frame));
  EXPECT_FALSE(reader.next(frame));
  EXPECT_LT(frame.frame.capacity(), 1000u);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tandem::protocol::test
