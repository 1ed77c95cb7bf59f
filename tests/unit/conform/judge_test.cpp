#include "launch/conform/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "common/error.hpp"
#include "dem_server/coupling/make_solver.hpp"
#include "launch/conform/report.hpp"
#include "launch/conform/scenes.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "protocol/codec.hpp"
#include "tests/doubles/broken_motion.hpp"
#include "tests/doubles/spoilt_channel.hpp"
#include "tests/doubles/thread_subject.hpp"

namespace tandem::test {
namespace {

using namespace protocol;
using namespace std::chrono_literals;
using conform::Outcome;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Judge, PassesOurMultibodyServer) {
  ThreadSubject ours(Role::mbd, std::function(mbd::make_solver));
  const conform::Judgement judgement = conform::judge(ours, {});
  std::printf("%s", conform::table(judgement).c_str());
  EXPECT_TRUE(judgement.passed());
  EXPECT_EQ(judgement.count(Outcome::passed), judgement.results.size());
}

TEST(Judge, PassesOurParticleServer) {
  ThreadSubject ours(Role::dem, std::function(dem::make_solver));
  const conform::Judgement judgement = conform::judge(ours, {});
  std::printf("%s", conform::table(judgement).c_str());
  EXPECT_TRUE(judgement.passed());
  EXPECT_EQ(judgement.count(Outcome::passed), judgement.results.size());
}

// ---- the conversation

int serve_ours(Channel& channel) {
  const auto solver = mbd::make_solver();
  return serve(channel, *solver, "double 1.0");
}

// Failed checks of a participant with our solver.
std::vector<std::string> failed(const ThreadSubject::Participant& participant,
                                const conform::Limits& limits = {}) {
  ThreadSubject subject(Role::mbd, participant);
  return conform::judge(subject, limits).failed();
}

TEST(Judge, NamesAParticipantThatLingers) {
  conform::Limits limits;
  limits.leave = 50ms;
  EXPECT_THAT(failed(
                  [](std::unique_ptr<Channel> channel) {
                    const int status = serve_ours(*channel);
                    std::this_thread::sleep_for(200ms);
                    return status;
                  },
                  limits),
              ElementsAre("finish", "closed_channel", "wrong_scene"));
}

TEST(Judge, NamesAWrongExitStatus) {
  EXPECT_THAT(failed([](std::unique_ptr<Channel> channel) { return serve_ours(*channel), 3; }),
              ElementsAre("finish"));
}

TEST(Judge, NamesALateAnswer) {
  // Only one check has so many windows.
  const MotionFault fault{.name = "late", .motion = [](MotionSet& motion, const LoadSet&) {
                            if (motion.window.index == 45) std::this_thread::sleep_for(1200ms);
                          }};
  EXPECT_THAT(failed([&](std::unique_ptr<Channel> channel) {
                const auto solver = broken(fault);
                return serve(*channel, *solver, "double 1.0");
              }),
              ElementsAre("answers_in_time"));
}

TEST(Judge, NamesAParticipantThatTakesWhateverComes) {
  const auto repaired = [](std::unique_ptr<Channel> channel) {
    SpoiltChannel spoilt(std::move(channel));
    Window next{0, {}, to_nanoseconds(1e-3)};
    spoilt.arrived = [&](std::vector<std::byte>& frame) {
      FrameHeader header;
      std::memcpy(&header, frame.data(), sizeof header);
      if (header.kind != Kind::advance_mbd || header.window > 1 || header.iteration > 0) return;
      LoadSet loads;
      decode(payload_of(frame), loads);
      if (loads.window.index == 0 || loads.window.begin != next.end) loads.window = next, header.window = 0;
      std::erase_if(loads.bodies, [](const BodyLoad& load) { return load.body > 2; });
      for (BodyLoad& load : loads.bodies)
        if (!is_finite(load.mean.torque)) load.mean.torque = {};
      Bytes payload;
      encode(payload, loads);
      seal(header, payload);
      frame.resize(sizeof header + payload.size());
      std::memcpy(frame.data(), &header, sizeof header);
      std::memcpy(frame.data() + sizeof header, payload.data(), payload.size());
    };
    return serve_ours(spoilt);
  };
  ThreadSubject subject(Role::mbd, repaired);
  EXPECT_THAT(conform::judge(subject, {}, {},
                             {"wrong_window", "wrong_order", "not_finite", "unknown_body", "free_fall"})
                  .failed(),
              ElementsAre("wrong_window", "not_finite", "unknown_body"));
}

TEST(Judge, NamesAParticipantThatDiesWithoutAReason) {
  EXPECT_THAT(failed([](std::unique_ptr<Channel> channel) {
                SpoiltChannel spoilt(std::move(channel));
                spoilt.passes = [](const FrameHeader& header) { return header.kind != Kind::failure; };
                return serve_ours(spoilt);
              }),
              ElementsAre("wrong_window", "wrong_order", "restore_unsaved", "not_finite", "unknown_body",
                          "wrong_scene"));
}

// ---- what is not judged

class Modest final : public MotionSolver {
 public:
  explicit Modest(std::string refused) : refused_(std::move(refused)) {}
  std::uint64_t capabilities() const override { return 0; }
  Configured configure(const Configuration& configuration) override {
    if (configuration.scene_text.find(refused_) != std::string::npos)
      throw Error(ErrorCode::scene, "has no joints", "mbd.joints", "give free bodies");
    return solver_->configure(configuration);
  }
  const MotionSet& advance(const LoadSet& loads) override { return solver_->advance(loads); }
  const BodiesFrame& observe() override { return solver_->observe(); }
  Report report() override { return solver_->report(); }

 private:
  std::string refused_;
  std::unique_ptr<MotionSolver> solver_ = mbd::make_solver();
};

conform::Judgement judge_modest(const std::string& refused) {
  ThreadSubject subject(Role::mbd, std::function([refused]() -> std::unique_ptr<MotionSolver> {
                          return std::make_unique<Modest>(refused);
                        }));
  return conform::judge(subject, {});
}

TEST(Judge, DoesNotJudgeWhatIsNotClaimedOrIsRefusedByName) {
  const conform::Judgement judgement = judge_modest("\"joints\": [");
  EXPECT_TRUE(judgement.passed());
  EXPECT_EQ(judgement.count(Outcome::failed), 0U);
  for (const conform::Result& result : judgement.results) {
    if (result.check->needs != 0) {
      EXPECT_EQ(result.outcome, Outcome::not_claimed) << result.check->name;
    }
    if (result.outcome == Outcome::refused) {
      EXPECT_THAT(result.sentence, HasSubstr("has no joints"));
    }
  }
  EXPECT_EQ(judgement.count(Outcome::refused), 2U);
  EXPECT_THAT(conform::table(judgement), HasSubstr("refused      joint_motion"));
}

class KnowsHookeOnly final : public LoadSolver {
 public:
  Configured configure(const Configuration& configuration) override {
    if (configuration.scene_text.find("hooke") == std::string::npos)
      throw Error(ErrorCode::scene, "is not known", "dem.contact", "use hooke");
    return solver_->configure(configuration);
  }
  const LoadSet& advance(const MotionSet& motion) override { return solver_->advance(motion); }
  const ParticlesFrame& observe() override { return solver_->observe(); }
  void save() override { solver_->save(); }
  void restore() override { solver_->restore(); }
  Report report() override { return solver_->report(); }

 private:
  std::unique_ptr<LoadSolver> solver_ = dem::make_solver();
};

TEST(Judge, TakesTheSimplestContactWhereTheLawIsRefused) {
  ThreadSubject subject(Role::dem, std::function([]() -> std::unique_ptr<LoadSolver> {
                          return std::make_unique<KnowsHookeOnly>();
                        }));
  const conform::Judgement judgement = conform::judge(subject, {});
  EXPECT_TRUE(judgement.passed()) << conform::table(judgement);
  EXPECT_EQ(judgement.count(Outcome::refused), 0U) << conform::table(judgement);
  for (const conform::Result& result : judgement.results)
    if (result.outcome == Outcome::passed && result.accepted) {
      EXPECT_THAT(result.scene, HasSubstr("hooke"));
    }
}

TEST(Judge, DoesNotPassAParticipantThatRefusesEachScene) {
  const conform::Judgement judgement = judge_modest("tandem\": \"1.0\"");
  EXPECT_FALSE(judgement.passed());
  EXPECT_EQ(judgement.failed(), std::vector<std::string>{});
  EXPECT_THAT(conform::last_line(judgement), HasSubstr("it refused each scene"));
}

TEST(Judge, JudgesOnASceneOfTheUser) {
  ThreadSubject ours(Role::mbd, std::function(mbd::make_solver));
  const auto scene = conform::judged_scene(conform::built_in_scene("joints").text, "mine.json");
  const conform::Judgement judgement = conform::judge(ours, {}, scene);
  EXPECT_TRUE(judgement.passed()) << conform::table(judgement);
  for (const conform::Result& result : judgement.results) {
    EXPECT_TRUE(result.check->any_scene);
    EXPECT_EQ(result.scene, "mine.json");
  }
  ThreadSubject grains(Role::dem, std::function(dem::make_solver));
  const auto tray = conform::judged_scene(conform::built_in_scene("tray").text, "mine.json");
  EXPECT_TRUE(conform::judge(grains, {}, tray).passed());
}

// ---- the report

TEST(Judge, WritesWhatItFound) {
  const MotionFault fault{.name = "<fault>", .load = [](LoadSet& loads) {
                            for (BodyLoad& load : loads.bodies) load.mean.torque = {};
                          }};
  ThreadSubject subject(Role::mbd, std::function([&] { return broken(fault); }));
  const conform::Judgement judgement = conform::judge(subject, {}, {}, {"torque_impulse", "free_fall"});
  const auto json = conform::to_json(judgement);
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["role"], "mbd");
  EXPECT_EQ(json["counts"]["failed"], 1);
  ASSERT_EQ(json["checks"].size(), 2U);
  const auto& check = json["checks"][1];
  EXPECT_EQ(check["check"], "torque_impulse");
  EXPECT_EQ(check["outcome"], "failed");
  EXPECT_EQ(check["findings"][0]["expected"].size(), 3U);
  EXPECT_EQ(check["findings"][0]["passed"], false);
  const std::string page = conform::page(judgement);
  EXPECT_THAT(page, HasSubstr("does not conform"));
  EXPECT_THAT(page, HasSubstr("angular momentum got by plate"));
}

TEST(Checks, HaveNamesOfTheirOwnAndAScene) {
  std::vector<std::string> names;
  for (const conform::Check& check : conform::checks()) {
    names.emplace_back(check.name);
    for (const Role role : {Role::mbd, Role::dem})
      if (check.of(role)) {
        EXPECT_EQ(conform::built_in_scene(check.scene(role)).role, role) << check.name;
      }
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace tandem::test
