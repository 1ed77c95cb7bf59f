// Errors of artificial runs with known values.
#include "launch/study/measures.hpp"

#include <cmath>

#include "tests/unit/study/study_folder.hpp"

namespace tandem::launch {
namespace {

class Measures : public StudyFolderTest {
 protected:
  void SetUp() override {
    StudyFolderTest::SetUp();
    put("run/bodies.csv", "time,b.position.x,b.position.z\n1,3,0\n2,0,0\n3,1,1\n");
    put("run/joints.csv", "time,h.q\n1,5\n2,6\n3,9\n");
    truth_.times = {1, 3};
    truth_.signals = {{"b.position.x", {0, 1}}, {"b.position.z", {4, 0}}, {"h.q", {5, 8}}};
  }
  double error(const Measure& measure) const {
    return errors_of_run(folder_ / "run", summary_, {measure}, truth_).front();
  }
  static Measure measure(std::vector<std::string> of, const std::string& error, double from = 0) {
    return {"m", std::move(of), error, from, 0, ""};
  }

  Truth truth_;
  const nlohmann::json summary_{{"drift", -0.5}, {"time_split", {{"dem", 2.0}}}, {"nothing", nullptr}};
};

TEST_F(Measures, LengthOfTheDifferenceOverTheTimes) {
  const std::vector<std::string> position{"b.position.x", "b.position.z"};  // differences (3, -4) and (0, 1)
  EXPECT_DOUBLE_EQ(error(measure(position, "largest")), 5);
  EXPECT_DOUBLE_EQ(error(measure(position, "last")), 1);
  EXPECT_DOUBLE_EQ(error(measure(position, "rms")), std::sqrt(13.0));
  EXPECT_DOUBLE_EQ(error(measure(position, "largest", 2)), 1);
  EXPECT_DOUBLE_EQ(error(measure({"h.q"}, "largest")), 1);
}

TEST_F(Measures, NumberOfTheSummary) {
  Measure drift = measure({"summary.drift"}, "largest");
  EXPECT_DOUBLE_EQ(error(drift), 0.5);
  drift.expected = 0.25;
  EXPECT_DOUBLE_EQ(error(drift), 0.75);
  EXPECT_TRUE(std::isnan(error(measure({"summary.nothing"}, "largest"))));
  EXPECT_TRUE(std::isnan(error(measure({"summary.absent"}, "largest"))));
}

TEST_F(Measures, FigureOfTheSignal) {
  put("reference/joints.csv", "time,h.q\n1,5\n2,6\n3,7\n");
  const Measure range = measure({"h.q"}, "range");
  const Truth truth = truth_of_run(folder_ / "reference", {range}, {1, 3});
  EXPECT_DOUBLE_EQ(errors_of_run(folder_ / "run", summary_, {range}, truth).front(), 2);  // 4 against 2
}

TEST_F(Measures, RunThatEndedEarlyHasNoError) {
  // The last row has no line break: a crash has truncated it.
  put("run/joints.csv", "time,h.q\n1,5\n2,6\n3,9");
  EXPECT_TRUE(std::isnan(error(measure({"h.q"}, "largest"))));
}

TEST_F(Measures, Refusals) {
  EXPECT_EQ(message([&] { error(measure({"h.rate"}, "largest")); }),
            "run: no file of the run holds the signal 'h.rate'");
  truth_.times = {1.5, 3};
  EXPECT_EQ(
      message([&] { error(measure({"h.q"}, "largest")); }),
      "signal 'h.q': no window ends at 1.500000 s (choose windows that divide the times of the reference)");
  put("run/joints.csv", "time,h.q\n1,five\n");
  EXPECT_EQ(message([&] { error(measure({"h.q"}, "largest")); }), "run/joints.csv: 'five' is no number");
}

}  // namespace
}  // namespace tandem::launch
