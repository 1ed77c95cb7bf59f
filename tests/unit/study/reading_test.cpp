// Order, front and cheapest setting of artificial rows.
#include "launch/study/reading.hpp"

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

}  // namespace
}  // namespace tandem::launch
