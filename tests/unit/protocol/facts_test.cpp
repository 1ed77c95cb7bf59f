// The facts that solvers may report.
#include "protocol/facts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol::test {
namespace {

using Json = nlohmann::ordered_json;

// The refusal of facts of the particle solver: violation and sentence.
std::string refusal(const std::string& facts) {
  try {
    SolverFacts taken;
    decode_facts(Role::dem, facts, taken);
  } catch (const ProtocolError& error) {
    return std::string(name(error.violation())) + ": " + error.what();
  }
  return "taken";
}

std::string nested(int depth) {
  return R"({"a": )" + std::string(static_cast<std::size_t>(depth), '[') +
         std::string(static_cast<std::size_t>(depth), ']') + "}";
}

TEST(Facts, AreAnObject) {
  EXPECT_EQ(refusal(R"({"device": "a", "warnings": ["b"]})"), "taken");
  EXPECT_EQ(refusal(""), "taken");
  EXPECT_EQ(refusal("[1]"), "bad_fact: dem_server: sent facts that are no JSON object in UTF-8: [1]");
  EXPECT_EQ(refusal(R"({"device": )"),
            R"(bad_fact: dem_server: sent facts that are no JSON object in UTF-8: {"device": )");
}

TEST(Facts, AreNoDeeperThanAnyOfOurs) {
  EXPECT_EQ(refusal(nested(60)), "taken");
  const std::string said = refusal(nested(1000000));
  EXPECT_NE(said.find("nested more than 64 deep: {\"a\": [[["), std::string::npos) << said;
  EXPECT_LT(said.size(), 200u);
}

TEST(Facts, OfAnotherTypeAreRefusedWithSolverKeyAndValue) {
  const auto expect = [](const char* facts, const std::string& said) {
    EXPECT_TRUE(refusal(facts).starts_with("bad_fact: dem_server: the fact " + said)) << refusal(facts);
  };
  expect(R"({"warnings": [1]})", R"("warnings" is [1], not a list of texts)");
  expect(R"({"micro_step_s": "short"})", R"("micro_step_s" is "short", not a number from 0 on [s])");
  expect(R"({"micro_step_s": null})", R"("micro_step_s" is null, not a number from 0 on [s])");
  expect(R"({"spheres": -1})", R"("spheres" is -1, not a count)");
  expect(R"({"spheres": 2.5})", R"("spheres" is 2.5, not a count)");
  expect(R"({"spheres": true})", R"("spheres" is true, not a count)");
  expect(R"({"device": 7})", R"("device" is 7, not a text)");
  expect(R"({"dem_state_hash": {}})", R"("dem_state_hash" is {}, not a text)");
}

TEST(Facts, ThatAreImpossibleAreRefusedWithSolverKeyAndValue) {
  const auto refused = [](Role role, const char* text) {
    SolverFacts facts;
    try {
      decode_facts(role, text, facts);
    } catch (const ProtocolError& error) {
      EXPECT_EQ(error.violation(), Violation::bad_fact);
      return error.problem();
    }
    return std::string("taken");
  };
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_energy_scale_J": -1})"),
            R"(the fact "mbd_energy_scale_J" is -1, not a number from 0 on [J])");
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_largest_energy_balance_J": -1})"), "taken") << "it has a sign";
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_position_error_estimate": -0.5})"),
            R"(the fact "mbd_position_error_estimate" is -0.5, not a number from 0 on or text)");
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_position_error_estimate": "none: too few steps"})"), "taken");
  EXPECT_EQ(refused(Role::dem, R"({"max_speed": -1e-9})"),
            R"(the fact "max_speed" is -1e-09, not a number from 0 on [m/s])");
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_steps": 0, "mbd_shortened_steps": 5})"),
            R"(the fact "mbd_shortened_steps" is 5, and "mbd_steps", of which it is a part, 0)");
  EXPECT_EQ(refused(Role::mbd, R"({"mbd_steps": 0, "mbd_shortened_steps": 0})"), "taken");
  EXPECT_EQ(refused(Role::dem, R"({"spheres": 10, "went_out": 11})"),
            R"(the fact "went_out" is 11, and "spheres", of which it is a part, 10)");
  EXPECT_EQ(refused(Role::dem, R"({"spheres": 10, "went_out": 10, "came_in": 10})"), "taken");
  EXPECT_EQ(refused(Role::sph, R"({"lost_kg": 2.5, "mass_in_all_kg": 2})"),
            R"(the fact "lost_kg" is 2.5, and "mass_in_all_kg", of which it is a part, 2.0)");
  EXPECT_EQ(refused(Role::sph, R"({"lost_kg": 2, "mass_in_all_kg": 2})"), "taken");
}

TEST(Facts, ThatAreNotFiniteAreRefusedWithSolverKeyAndValue) {
  for (const char* value : {"NaN", "Infinity", "-Infinity", "nan", "-inf"})
    for (const char* end : {"}", ", \"device\": \"a\"}", " }"})
      EXPECT_EQ(refusal(std::string(R"({"contacts": 3, "max_speed": )") + value + end),
                std::string("not_finite: dem_server: the fact \"max_speed\" is ") + value + ", not finite");
  EXPECT_EQ(refusal(R"({"max_speed": 1e999})"),
            "not_finite: dem_server: the fact \"max_speed\" is beyond the largest double, not finite");
  // In free information as well: summary.json could not hold it.
  EXPECT_EQ(refusal(R"({"other": NaN})"), "not_finite: dem_server: the fact \"other\" is NaN, not finite");
}

TEST(Facts, OfNobodyAreTakenAsTheyAre) {
  SolverFacts facts;
  const Json all =
      decode_facts(Role::dem, R"({"mine": [1, null, {"x": -1}], "dof": "no fact of dem"})", facts);
  EXPECT_EQ(all.dump(), R"({"mine":[1,null,{"x":-1}],"dof":"no fact of dem"})");
  EXPECT_FALSE(facts.mbd.dof);
}

TEST(Facts, MayAllBeAbsent) {
  SolverFacts facts;
  for (const char* text : {"", "{}"})
    for (const Role role : {Role::mbd, Role::dem}) EXPECT_EQ(decode_facts(role, text, facts).dump(), "{}");
  EXPECT_FALSE(facts.mbd.dof);
  EXPECT_FALSE(facts.dem.spheres);
}

TEST(Facts, CountsMayBeWrittenAsDoubles) {
  SolverFacts facts;
  decode_facts(Role::dem, R"({"spheres": 3.0, "sphere_steps": 1e6})", facts);
  EXPECT_EQ(facts.dem.spheres, 3u);
  EXPECT_EQ(facts.dem.sphere_steps, 1000000u);
  EXPECT_TRUE(refusal(R"({"spheres": 1e17})").starts_with("bad_fact"));
}

TEST(Facts, ComeBackAsTheyWereSent) {
  MbdFacts sent;
  sent.dof = 3;
  sent.size = 1.0 / 3;
  sent.warnings = {"one", "two"};
  sent.state_hash = "abc";
  sent.position_error = fact::Estimate{0.25, ""};
  sent.energy_error = fact::Estimate{{}, "not estimated: too few steps"};
  const std::string text = encode_facts(sent, Json{{"free", 1}});
  SolverFacts facts;
  const Json all = decode_facts(Role::mbd, text, facts);
  EXPECT_EQ(all["free"], 1);
  EXPECT_TRUE(all["mbd_local_error_sum"].is_null());
  EXPECT_FALSE(all.contains("mbd_steps"));
  EXPECT_EQ(facts.mbd.dof, 3u);
  EXPECT_EQ(facts.mbd.size, 1.0 / 3);
  EXPECT_EQ(facts.mbd.warnings, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(facts.mbd.state_hash, "abc");
  EXPECT_EQ(facts.mbd.position_error.value().value, 0.25);
  EXPECT_FALSE(facts.mbd.energy_error.value().value);
  EXPECT_EQ(facts.mbd.energy_error.value().reason, "not estimated: too few steps");
  EXPECT_FALSE(facts.mbd.steps);
  EXPECT_FALSE(facts.mbd.local_error_sum);
  EXPECT_EQ(encode_facts(facts.mbd, Json{{"free", 1}}), text);
}

TEST(Facts, LaterOnesReplaceEarlierOnes) {
  SolverFacts facts;
  decode_facts(Role::mbd, R"({"dof": 3, "mbd_local_error_sum": 0.5})", facts);
  decode_facts(Role::mbd, R"({"mbd_local_error_sum": null})", facts);
  EXPECT_EQ(facts.mbd.dof, 3u);
  EXPECT_FALSE(facts.mbd.local_error_sum);
}

TEST(Facts, ThatAreNotFiniteAreNotSent) {
  DemFacts facts;
  for (const double value : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    facts.max_speed = value;
    try {
      encode_facts(facts, {});
      ADD_FAILURE();
    } catch (const ProtocolError& error) {
      EXPECT_EQ(error.violation(), Violation::not_finite);
      EXPECT_EQ(error.code(), ErrorCode::numerics);
      EXPECT_EQ(error.where(), "dem_server");
      EXPECT_NE(error.problem().find("\"max_speed\" is "), std::string::npos) << error.what();
    }
  }
}

std::string refusal_of(const std::string& text) {
  SolverFacts facts;
  try {
    decode_facts(Role::dem, text, facts);
  } catch (const ProtocolError& error) {
    EXPECT_EQ(error.violation(), Violation::bad_fact);
    return error.what();
  }
  return {};
}

TEST(Facts, HaveWordsAsKeys) {
  for (const std::string key : {"", " ", "a b", "summary.x", "a\\nb", "\xc3\xa9", "%"})
    EXPECT_NE(refusal_of("{\"" + key + "\": 1}").find("sent a fact with the key"), std::string::npos) << key;
  EXPECT_NE(refusal_of("{\"" + std::string(101, 'x') + "\": 1}"), "");
  EXPECT_EQ(refusal_of("{\"" + std::string(100, 'x') + "\": 1, \"a_B-9\": 2}"), "");
  EXPECT_EQ(refusal_of(R"({"inlets": {"caf\u00e9 no. 1": {"came_in": 3}}})"), "") << "names of a scene";
}

TEST(Facts, AreBounded) {
  const auto elements = [](std::size_t count) {
    std::string text = "{\"list\": [0";
    for (std::size_t i = 1; i < count; ++i) text += ",0";
    return text + "]}";
  };
  const std::string too_many = "sent more than 20000 facts and elements";
  // The list and the object that holds it count as well.
  EXPECT_EQ(refusal_of(elements(most_facts - 2)), "");
  EXPECT_NE(refusal_of(elements(most_facts - 1)).find(too_many), std::string::npos);
  std::string warnings = "{\"warnings\": [\"\"";
  for (std::size_t i = 0; i < most_facts; ++i) warnings += ",\"\"";
  EXPECT_NE(refusal_of(warnings + "]}").find(too_many), std::string::npos);
  std::string facts = "{";
  for (int i = 0; i < 3'000; ++i) facts += (i > 0 ? ",\"f" : "\"f") + std::to_string(i) + "\":0";
  EXPECT_EQ(refusal_of(facts + '}'), "");
  EXPECT_NE(refusal_of("{\"a\": \"" + std::string(6'000'000, 'x') + "\"}").find("sent facts of 600000"),
            std::string::npos);
}

TEST(Facts, AreDeclaredOnce) {
  DemFacts facts;
  facts.spheres = 1;
  EXPECT_EQ(encode_facts(facts, {}), R"({"spheres":1})");
  EXPECT_THROW(encode_facts(facts, Json{{"spheres", 2}}), Error);
  EXPECT_THROW(encode_facts(facts, Json{{"device", "a"}}), Error);
}

}  // namespace
}  // namespace tandem::protocol::test
