// Order, front and cheapest setting of artificial rows.
#include "launch/study/explicit_method.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace tandem::launch {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;

Row row(const std::string& scheme, double window, double error, double cpu,
        const std::string& status = "ok") {
  PlannedRun run;
  const nlohmann::json::json_pointer anywhere("");
  run.settings = {{"scheme", anywhere, scheme}, {"window", anywhere, window}};
  return {run, status, "", {error}, cpu, {}};
}
constexpr double none = std::numeric_limits<double>::quiet_NaN();

TEST(Reading, OrderIsTheSlopeOfTheLogarithms) {
  std::vector<Row> rows;
  for (const double h : {0.04, 0.01, 0.02}) {
    rows.push_back(row("a", h, 7 * h * h, 1));
    rows.push_back(row("b", h, 3 * std::pow(h, 1.5), 1));
  }
  rows.push_back(row("b", 0.08, none, 1, "diverged"));
  const std::vector<Series> series = series_of(rows, "window", 0);
  ASSERT_EQ(series.size(), 2u);
  EXPECT_EQ(series[0].label, "scheme=a");
  EXPECT_THAT(series[0].steps, ElementsAre(0.01, 0.02, 0.04));
  EXPECT_NEAR(series[0].order().value(), 2, 1e-12);
  EXPECT_THAT(series[0].orders, Each(DoubleNear(2, 1e-12)));
  EXPECT_NEAR(series[1].order().value(), 1.5, 1e-12);
}

TEST(Reading, OneRowHasNoOrder) {
  EXPECT_FALSE(series_of({row("a", 0.1, 1, 1), row("a", 0.2, none, 1, "diverged")}, "window", 0)[0]
                   .order()
                   .has_value());
}

TEST(Reading, FrontIsWhatNoOtherRowBeats) {
  const std::vector<Row> rows{
      row("a", 1, 0.1, 3),           row("a", 2, 0.2, 2),  row("a", 3, 0.3, 2.5), row("a", 4, 0.05, 9),
      row("b", 1, 0, 0, "diverged"), row("b", 2, none, 0), row("b", 3, 0.2, 2),   row("b", 4, 0.1, 4)};
  EXPECT_THAT(pareto_front(rows, 0), ElementsAre(1, 0, 3));
}

TEST(Reading, CheapestIsTheFastestThatIsGoodEnough) {
  const std::vector<Row> rows{row("a", 1, 0.1, 3), row("a", 2, 0.2, 2), row("a", 3, 0.01, 9),
                              row("b", 1, 0, 0, "diverged")};
  EXPECT_EQ(cheapest(rows, 0, 0.15), std::optional<std::size_t>(0));
  EXPECT_EQ(cheapest(rows, 0, 0.2), std::optional<std::size_t>(1));
  EXPECT_FALSE(cheapest(rows, 0, 0.001).has_value());
}

Row by(const nlohmann::json& integrator, double error, double cpu) {
  PlannedRun run;
  run.settings = {{"integrator", nlohmann::json::json_pointer("/mbd/integrator"), integrator}};
  return {run, "ok", "", {error}, cpu, {}};
}

// At an error of 1e-4, which both methods have reached, the explicit one takes 0.5 s and the implicit one 2
// s.
TEST(Reading, SuggestsTheExplicitMethodWhereItWins) {
  const nlohmann::json fast{{"method", "dormand_prince"}};
  std::vector<Row> rows{by({{"step", .1}}, 1e-2, .1), by({{"step", .01}}, 1e-4, 2), by(fast, 1e-3, .4),
                        by(fast, 1e-5, .5)};
  EXPECT_EQ(
      compare_methods(rows, 0),
      "  suggested: method=dormand_prince, 0.5 s for an error of 0.0001, where generalized_alpha takes 2 "
      "s\n");
  rows[3].cpu = 3;
  EXPECT_THAT(compare_methods(rows, 0), testing::HasSubstr("does not win: 3 s"));
  EXPECT_EQ(compare_methods({rows[0], rows[1]}, 0), "");
}

TEST(Reading, ExplicitMethodIsForTreesWithoutLimits) {
  scene::Mbd mbd;
  mbd.bodies.resize(2);
  mbd.joints.resize(2);
  for (scene::Joint& joint : mbd.joints) joint.type = scene::JointType::revolute, joint.parent = ground;
  mbd.joints[0].child = BodyId{0}, mbd.joints[1].child = BodyId{1};
  EXPECT_TRUE(suits_explicit_method(mbd));
  mbd.joints[1].limits.emplace();
  EXPECT_FALSE(suits_explicit_method(mbd)) << "limits";
  mbd.joints[1].limits.reset();
  mbd.joints[1].friction = scene::Friction{.force = 1, .breakaway = 2};
  EXPECT_FALSE(suits_explicit_method(mbd)) << "stiction";
  mbd.joints[1].friction.reset();
  mbd.joints.push_back(mbd.joints[1]);
  mbd.joints[2].parent = BodyId{0};
  EXPECT_FALSE(suits_explicit_method(mbd)) << "a loop";
}

}  // namespace
}  // namespace tandem::launch
