#include "common/scene/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/error_of.hpp"

namespace tandem::scene {
namespace parameters_test {

using nlohmann::json;
using tandem::test::error_of;
using ::testing::HasSubstr;

json put_in(json document, const std::map<std::string, double>& set = {}) {
  std::string text = document.dump();
  put_in_parameters(text, set, "hopper.json");
  return json::parse(text);
}
std::string error(const json& document, const std::map<std::string, double>& set = {}) {
  return error_of([&] { put_in(document, set); });
}
const json hopper = json::parse(R"json({
  "parameters": {"mouth": 0.06, "lip": "=mouth/3", "pitch": {"value": 20, "unit": "deg", "min": 0, "max": 45}},
  "size": [1, "=mouth/2 - 0.01*cos(pitch)"], "angle": "=pitch", "angle_deg": "=pitch + 10*deg",
  "euler_deg": ["=90", 0, 0], "count": "=6*2", "body": {"lip": "=lip"},
  "solver_options": {"formula": "=untouched"}})json");

TEST(Parameters, AreNumbersInTheScene) {
  const json scene = put_in(hopper);
  EXPECT_FALSE(scene.contains("parameters"));
  EXPECT_DOUBLE_EQ(scene["size"][1], 0.03 - 0.01 * std::cos(std::numbers::pi / 9));
  EXPECT_DOUBLE_EQ(scene["angle"], std::numbers::pi / 9);
  EXPECT_DOUBLE_EQ(scene["angle_deg"], 30);
  EXPECT_DOUBLE_EQ(scene["euler_deg"][0], 90);
  EXPECT_TRUE(scene["count"].is_number_integer());
  EXPECT_DOUBLE_EQ(scene["body"]["lip"], 0.02);
  EXPECT_EQ(scene["solver_options"]["formula"], "=untouched");
}

TEST(Parameters, AreSetInTheirUnits) {
  const json scene = put_in(hopper, {{"pitch", 45}, {"mouth", 0.09}});
  EXPECT_DOUBLE_EQ(scene["angle"], std::numbers::pi / 4);
  EXPECT_DOUBLE_EQ(scene["body"]["lip"], 0.03);
  std::string text = hopper.dump();
  const std::vector<Parameter> values = put_in_parameters(text, {{"pitch", 45}}, "hopper.json");
  ASSERT_EQ(values.size(), 3u);
  EXPECT_EQ(values[2].name, "pitch");
  EXPECT_EQ(values[2].value, 45);
  EXPECT_EQ(values[2].unit, "deg");
}

TEST(Parameters, LeaveOtherScenesAsTheyAre) {
  std::string text = "{\"name\":  \"x\"}";
  EXPECT_TRUE(put_in_parameters(text, {}, "x.json").empty());
  EXPECT_EQ(text, "{\"name\":  \"x\"}");
}

TEST(Parameters, AreRefusedWithPlaceAndRemedy) {
  EXPECT_THAT(error(hopper, {{"pitch", 46}}), HasSubstr("46 is above 'max', 45"));
  EXPECT_THAT(error(hopper, {{"moth", 1}}), HasSubstr("did you mean 'mouth'?"));
  EXPECT_THAT(error({{"parameters", {{"a", "=b"}, {"b", "=c"}, {"c", "=b"}}}}),
              HasSubstr("a cycle: a -> b -> c -> b"));
  EXPECT_THAT(error({{"x", {1, "=muoth"}}, {"parameters", {{"mouth", 1}}}}),
              testing::AllOf(HasSubstr("hopper.json: x[1]"), HasSubstr("did you mean 'mouth'?")));
  EXPECT_THAT(error({{"parameters", {{"deg", 1}}}}), HasSubstr("of their own"));
  EXPECT_THAT(error({{"parameters", {{"two words", 1}}}}), HasSubstr("no name"));
  EXPECT_THAT(error({{"parameters", {{"a", {{"value", 1}, {"unit", "mm"}}}}}}),
              HasSubstr("is no unit of parameters"));
  EXPECT_THAT(error({{"parameters", {{"a", {{"value", 1}, {"uint", "m"}}}}}}),
              HasSubstr("did you mean 'unit'?"));
  EXPECT_THAT(error({{"parameters", {{"a", "1"}}}}), HasSubstr("no value"));
  EXPECT_THAT(error({{"parameters", {{"a", {{"value", "=1*deg"}, {"unit", "m"}}}}}}),
              HasSubstr("an angle, and the unit is 'm'"));
  EXPECT_THAT(error({{"parameters", 1}}), HasSubstr("it is no object"));
  EXPECT_THAT(error({{"x", "=1*deg*deg"}}), HasSubstr("power of an angle"));
  EXPECT_THAT(error({{"x", "="}}), HasSubstr("it ends where"));
}

}  // namespace parameters_test
}  // namespace tandem::scene
