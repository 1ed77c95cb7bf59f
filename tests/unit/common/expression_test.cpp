#include "common/scene/expression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tandem::scene {
namespace expression_test {

using ::testing::HasSubstr;

Quantity value_of(const std::string& name) {
  if (name == "mouth") return {0.06, 0};
  if (name == "pitch") return {std::numbers::pi / 9, 1};
  throw ExpressionError("unknown name '" + name + "'");
}
double number(const std::string& text) {
  const Quantity q = evaluate(text, value_of);
  EXPECT_EQ(q.angle, 0) << text;
  return q.value;
}
std::string error(const std::string& text) {
  try {
    evaluate(text, value_of);
  } catch (const ExpressionError& e) {
    return e.what();
  }
  return "none";
}

TEST(Expression, HasTheOrderOfArithmetic) {
  EXPECT_DOUBLE_EQ(number("1 + 2*3 - 8/4/2"), 6);
  EXPECT_DOUBLE_EQ(number("-2^2"), -4);
  EXPECT_DOUBLE_EQ(number("2^-1"), 0.5);
  EXPECT_DOUBLE_EQ(number("2^3^2"), 512);
  EXPECT_DOUBLE_EQ(number("(1 + 2)*-3"), -9);
  EXPECT_DOUBLE_EQ(number("1.5e-3*.5"), 7.5e-4);
  EXPECT_DOUBLE_EQ(number("2 - -3"), 5);
  EXPECT_DOUBLE_EQ(number("max(1, 5, 3) - min(2, 1) + hypot(3, 4) + round(0.6) + sqrt(16) + abs(-1)"), 15);
}

TEST(Expression, KnowsAngles) {
  EXPECT_DOUBLE_EQ(number("mouth/2 - 0.01*cos(pitch)"), 0.03 - 0.01 * std::cos(std::numbers::pi / 9));
  EXPECT_DOUBLE_EQ(number("pitch/deg"), 20);
  EXPECT_DOUBLE_EQ(number("sin(90*deg) + tan(pi/4)"), 2);
  const Quantity sum = evaluate("pitch + 10*deg", value_of);
  EXPECT_EQ(sum.angle, 1);
  EXPECT_DOUBLE_EQ(sum.value, std::numbers::pi / 6);
  EXPECT_EQ(evaluate("atan2(1, 2)", value_of).angle, 1);
  EXPECT_EQ(evaluate("1/pitch", value_of).angle, -1);
  EXPECT_EQ(evaluate("pitch^2", value_of).angle, 2);
  EXPECT_THAT(error("pitch + 0.1"), HasSubstr("an angle and a number"));
  EXPECT_THAT(error("sqrt(pitch)"), HasSubstr("divide it by deg"));
  EXPECT_THAT(error("cos(pitch*pitch)"), HasSubstr("power of an angle"));
  EXPECT_THAT(error("max(pitch, 1)"), HasSubstr("an angle and a number"));
}

TEST(Expression, SaysWhereItIsWrong) {
  EXPECT_THAT(error("1 + "), HasSubstr("it ends where"));
  EXPECT_THAT(error("2 mouth"), HasSubstr("'m' in column 3"));
  EXPECT_THAT(error("mouht"), HasSubstr("unknown name 'mouht'"));
  EXPECT_THAT(error("0x10"), HasSubstr("column 1"));
  EXPECT_THAT(error("cos(1"), HasSubstr("it ends where ')'"));
  EXPECT_THAT(error("cos"), HasSubstr("it ends where '('"));
  EXPECT_THAT(error("atan2(1)"), HasSubstr("takes 2 values, not 1"));
  EXPECT_THAT(error("1/0"), HasSubstr("division by zero"));
  EXPECT_THAT(error("1e308*10"), HasSubstr("not a finite number"));
  EXPECT_THAT(error("sqrt(-1)"), HasSubstr("not a finite number"));
  EXPECT_THAT(error("1;2"), HasSubstr("';' in column 2"));
  EXPECT_THAT(error(std::string(200, '(') + "1"), HasSubstr("levels of brackets"));
  EXPECT_THAT(error(std::string(100000, '-') + "1"), HasSubstr("levels of brackets"));
}

}  // namespace expression_test
}  // namespace tandem::scene
