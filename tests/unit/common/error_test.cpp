#include "common/error.hpp"

#include <gtest/gtest.h>

namespace tandem {
namespace {

TEST(Error, TextIsWhereProblemHint) {
  const Error error(ErrorCode::scene, "mass is -1 kg", "scene.json: mbd.bodies[2].mass", "give a mass > 0");
  EXPECT_STREQ(error.what(), "scene.json: mbd.bodies[2].mass: mass is -1 kg (give a mass > 0)");
  EXPECT_EQ(error.code(), ErrorCode::scene);
  EXPECT_EQ(error.problem(), "mass is -1 kg");
}

TEST(Error, WhereAndHintMayBeEmpty) {
  EXPECT_STREQ(Error(ErrorCode::numerics, "no convergence").what(), "no convergence");
  EXPECT_STREQ(Error(ErrorCode::numerics, "no convergence", "mbd").what(), "mbd: no convergence");
}

TEST(Error, ExitStatusOfEveryCode) {
  EXPECT_EQ(exit_status(ErrorCode::internal), 70);
  EXPECT_EQ(exit_status(ErrorCode::usage), 2);
  EXPECT_EQ(exit_status(ErrorCode::scene), 2);
  EXPECT_EQ(exit_status(ErrorCode::numerics), 3);
  EXPECT_EQ(exit_status(ErrorCode::protocol), 4);
  EXPECT_EQ(exit_status(ErrorCode::peer_lost), 4);
  EXPECT_EQ(exit_status(ErrorCode::timeout), 4);
  EXPECT_EQ(exit_status(ErrorCode::resource), 5);
  EXPECT_EQ(exit_status(ErrorCode::interrupted), 130);
}

}  // namespace
}  // namespace tandem
