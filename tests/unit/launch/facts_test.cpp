// The facts that solvers may send.
#include "launch/coordinator/facts.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

std::string refusal(const std::string& facts) {
  try {
    parse_facts(protocol::Role::dem, facts);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::protocol);
    return error.what();
  }
  return "taken";
}

std::string nested(int depth) {
  return R"({"a": )" + std::string(static_cast<std::size_t>(depth), '[') +
         std::string(static_cast<std::size_t>(depth), ']') + "}";
}

TEST(Facts, AreAnObject) {
  EXPECT_EQ(refusal(R"({"device": "a", "warnings": ["b"]})"), "taken");
  EXPECT_EQ(refusal("[1]"), "dem_server: sent facts that are no JSON object in UTF-8: [1]");
  EXPECT_EQ(refusal(R"({"warnings": [1]})"),
            R"(dem_server: sent facts whose warnings are no list of sentences: {"warnings": [1]})");
}

TEST(Facts, AreNoDeeperThanAnyOfOurs) {
  EXPECT_EQ(refusal(nested(60)), "taken");
  const std::string said = refusal(nested(1000000));
  EXPECT_NE(said.find("nested more than 64 deep: {\"a\": [[["), std::string::npos) << said;
  EXPECT_LT(said.size(), 200u);
}

}  // namespace
}  // namespace tandem::launch
