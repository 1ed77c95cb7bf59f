// Participants that are right for a second, and then wrong: only the long checks see them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dem_server/coupling/make_solver.hpp"
#include "launch/conform/judge.hpp"
#include "launch/conform/report.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "tests/doubles/broken_load.hpp"
#include "tests/doubles/broken_motion.hpp"
#include "tests/doubles/thread_subject.hpp"

namespace tandem::test {
namespace {

using namespace protocol;
using conform::Outcome;
using ::testing::HasSubstr;

bool is_after_a_second(const Window& window) {
  return window.begin >= Nanoseconds{1'000'000'000};
}

conform::Judgement judged_long(conform::Subject& subject, const char* check) {
  conform::Limits limits;
  limits.long_run = 2;
  return conform::judge(subject, limits, {}, {check});
}
std::string worst_of(const conform::Judgement& judgement) {
  const conform::Finding* worst = judgement.results.at(0).worst();
  return worst ? worst->what : "";
}

TEST(LongRun, OursPassesAndOthersAreLeftOut) {
  ThreadSubject bodies(Role::mbd, std::function(mbd::make_solver));
  ThreadSubject particles(Role::dem, std::function(dem::make_solver));
  for (const auto& [subject, check] :
       {std::pair<conform::Subject*, const char*>{&bodies, "long_motion"}, {&particles, "long_load"}}) {
    const conform::Judgement judgement = judged_long(*subject, check);
    ASSERT_EQ(judgement.results.size(), 1u);
    EXPECT_TRUE(judgement.passed()) << conform::row(judgement.results[0]);
    EXPECT_GE(judgement.results[0].findings.size(), 20u);
  }
}

TEST(LongRun, IsNotTriedUnlessItIsAskedFor) {
  for (const conform::Check& check : conform::checks())
    EXPECT_EQ(check.is_long, std::string_view(check.name).starts_with("long_")) << check.name;
  ThreadSubject bodies(Role::mbd, std::function(mbd::make_solver));
  for (const conform::Result& result : conform::judge(bodies, {}).results)
    EXPECT_FALSE(result.check->is_long) << result.check->name;
}

TEST(LongRun, LoadsThatAreHalvedAfterASecondAreFound) {
  const MotionFault fault{.name = "tires", .load = [](LoadSet& loads) {
                            if (is_after_a_second(loads.window))
                              for (BodyLoad& load : loads.bodies) load.mean.force = 0.5 * load.mean.force;
                          }};
  ThreadSubject subject(Role::mbd, std::function([&] { return broken(fault); }));
  const conform::Judgement judgement = judged_long(subject, "long_motion");
  EXPECT_EQ(judgement.results.at(0).outcome, Outcome::failed);
  EXPECT_THAT(worst_of(judgement), HasSubstr("momentum got by"));
}

TEST(LongRun, TorquesThatTurnAfterASecondAreFound) {
  const LoadFault fault{.name = "turns", .load = [](LoadSet& loads, const MotionSet&) {
                          if (is_after_a_second(loads.window))
                            for (BodyLoad& load : loads.bodies) load.mean.torque = -load.mean.torque;
                        }};
  ThreadSubject subject(Role::dem, std::function([&] { return broken(fault); }));
  const conform::Judgement judgement = judged_long(subject, "long_load");
  EXPECT_EQ(judgement.results.at(0).outcome, Outcome::failed);
  EXPECT_THAT(worst_of(judgement), HasSubstr("torque on the tray in the 0.1 s before t = "));
}

TEST(LongRun, AParticipantThatEndsAfterASecondIsFound) {
  const LoadFault fault{.name = "ends", .load = [](LoadSet& loads, const MotionSet&) {
                          if (is_after_a_second(loads.window))
                            throw Error(ErrorCode::numerics, "the licence is over");
                        }};
  ThreadSubject subject(Role::dem, std::function([&] { return broken(fault); }));
  const conform::Judgement judgement = judged_long(subject, "long_load");
  EXPECT_EQ(judgement.results.at(0).outcome, Outcome::failed);
  EXPECT_THAT(judgement.results.at(0).sentence, HasSubstr("the licence is over"));
}

}  // namespace
}  // namespace tandem::test
