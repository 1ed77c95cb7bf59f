#include "launch/conform/judge.hpp"

#include <gtest/gtest.h>

#include "dem_server/coupling/make_solver.hpp"
#include "launch/conform/report.hpp"
#include "mbd_server/coupling/make_solver.hpp"
#include "tests/doubles/thread_subject.hpp"

namespace tandem::test {
namespace {

using protocol::Role;

TEST(Judge, PassesOurMultibodyServer) {
  ThreadSubject ours(Role::mbd, std::function(mbd::make_solver));
  const conform::Judgement judgement = conform::judge(ours, {});
  std::printf("%s", conform::table(judgement).c_str());
  EXPECT_TRUE(judgement.passed());
  EXPECT_EQ(judgement.count(conform::Outcome::passed), judgement.results.size());
}

TEST(Judge, PassesOurParticleServer) {
  ThreadSubject ours(Role::dem, std::function(dem::make_solver));
  const conform::Judgement judgement = conform::judge(ours, {});
  std::printf("%s", conform::table(judgement).c_str());
  EXPECT_TRUE(judgement.passed());
  EXPECT_EQ(judgement.count(conform::Outcome::passed), judgement.results.size());
}

}  // namespace
}  // namespace tandem::test
