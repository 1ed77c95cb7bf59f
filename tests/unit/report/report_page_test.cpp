// report.html of artificial runs: missing files of a folder are left out of the page, which is still written.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "coordinator/report/data_folder.hpp"
#include "coordinator/report/report.hpp"

namespace tandem::launch {
namespace {

class Report : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void put(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string page() const {
    EXPECT_TRUE(write_report(folder_));
    std::ostringstream text;
    text << std::ifstream(folder_ / "report.html").rdbuf();
    return text.str();
  }
  static bool has(const std::string& page, const std::string& text) {
    return page.find(text) != std::string::npos;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_report_" + std::to_string(getpid()));
};

TEST_F(Report, DataFolderIsBesideThePrograms) {
  EXPECT_TRUE(std::filesystem::exists(data_folder() / "report.py"));
  EXPECT_TRUE(std::filesystem::exists(data_folder() / "schema.json"));
  EXPECT_TRUE(std::filesystem::is_directory(data_folder() / "scenes"));
}

TEST_F(Report, WholeRun) {
  put("summary.json", R"({"scene": "s<1>", "status": "ok", "simulated_s": 1, "spheres": 52000, "wall_s": 2.5,
      "time_split": {"dem": 2, "mbd": 0.2}, "warnings": ["odd & even"], "left_out": ["loops"],
      "checks": [{"name": "weight", "of": "box.contact_force.z", "reduce": "mean", "value": 9.9, "expected": 10,
                  "error": 0.01, "tolerance": 0.02, "absolute": false, "passed": true, "why": "m g"}]})");
  put("bodies.csv", "time,box.position.x,box.position.y,box.position.z\n0,0,0,0\n1,0,0,2\n");
  put("joints.csv", "time,hinge.q\n0,0\n1,3\n");
  put("windows.csv", "window,time,kinetic_energy\n0,0,1\n1,1,2\n");
  const std::string text = page();
  for (const char* part : {"s&lt;1&gt;", "all checks passed", "weight", "passed", "odd &amp; even", "loops",
                           "box: position", "hinge: coordinate", "Kinetic energy", "dem 2 s"}) {
    EXPECT_TRUE(has(text, part)) << part;
  }
  EXPECT_FALSE(has(text, "contact force</")) << "nothing to show";
  EXPECT_FALSE(has(text, "http://") && has(text, "src=\"http")) << "self-contained";
}

TEST_F(Report, FailedRunWithoutARow) {
  put("summary.json",
      R"({"scene": "s", "status": "failed", "checks": [], "backend": null, "simulated_s": 0.25,
      "end_time_s": 1.0, "error": {"code": "numerics", "what": "the step diverged", "where": "mbd_server", "hint": "smaller window"}})");
  put("bodies.csv", "time,box.position.x\n");
  put("windows.csv", "");  // the run died when the file was created
  const std::string text = page();
  for (const char* part : {"<b>the step diverged</b>", "in mbd_server", "What to do: smaller window",
                           "kind of error: numerics", "t = 0.25 s of 1 s", "did not reach its end"}) {
    EXPECT_TRUE(has(text, part)) << part;
  }
}

TEST_F(Report, RowCutShortByACrash) {
  put("summary.json", R"({"scene": "s", "status": "failed"})");
  put("joints.csv", "time,hinge.q\n0,0\n1,3\n2");
  EXPECT_TRUE(has(page(), "hinge: coordinate"));
}

TEST_F(Report, OfALongFileStretchesAreReadAndThePageSaysSo) {
  put("summary.json", R"({"scene": "s", "status": "ok"})");
  std::string rows = "time,hinge.q\n";
  for (int i = 0; i < 150'000; ++i) rows += std::to_string(100'000 + i) + ',' + std::to_string(i % 7) + '\n';
  put("joints.csv", rows);
  const std::string text = page();
  EXPECT_TRUE(has(text, "hinge: coordinate"));
  EXPECT_TRUE(has(text, "joints.csv has about 1.5e+05 rows")) << text.substr(0, 3000);
}

TEST_F(Report, WhetherARunGoesOnIsAskedOfTandem) {
  // The process that wrote this summary is gone; only tandem, in the script's folder, can determine that.
  put("summary.json",
      R"({"scene": "s", "status": "running", "process": {"host": "elsewhere", "pid": 1, "started": 1}})");
  put("tandem_run.json", "");
  const std::string text = page();
  EXPECT_TRUE(has(text, "died: its program ended without a word") || has(text, "tandem ps says"))
      << text.substr(0, 3000);
}

TEST_F(Report, CheckWithoutANumber) {
  put("summary.json",
      R"({"scene": "s", "status": "failed", "reason": "checks", "checks": [{"name": "c", "of": "a.q", "reduce": "period",
      "value": null, "expected": 1, "error": null, "tolerance": 0.1, "absolute": true, "passed": false, "why": ""}]})");
  const std::string text = page();
  EXPECT_TRUE(has(text, "FAILED"));
  EXPECT_TRUE(has(text, "failed: a check failed"));
}

TEST_F(Report, SuspectRunIsAmberAndSaysWhy) {
  put("summary.json",
      R"({"scene": "s", "status": "suspect", "verdict": {"status": "suspect", "judged": ["overlap"],
      "lines": [{"rule": "overlap", "of": "the run", "value": 0.24, "limit": 0.05, "sentence": "use young < 1e9"}],
      "not_judged": ["bodies & walls"]}})");
  const std::string text = page();
  for (const char* part :
       {"class=\"status warn\">suspect<", "What makes this run suspect", "<b>overlap</b>: use young &lt; 1e9",
        "Rules that were judged: overlap.", "bodies &amp; walls"})
    EXPECT_TRUE(has(text, part)) << part;
}

TEST_F(Report, FailedRunHasTheVerdictBesides) {
  put("summary.json",
      R"({"scene": "s", "status": "failed", "reason": "checks", "checks": [], "verdict": {"lines": [
      {"rule": "overlap", "of": "the run", "value": 0.24, "limit": 0.05, "sentence": "use another"}]}})");
  const std::string text = page();
  EXPECT_TRUE(has(text, "Other findings"));
  EXPECT_FALSE(has(text, "makes this run suspect"));
}

// At the start from the summary, at later instants from bits of the columns.
TEST_F(Report, ReactionsThatAreNotDetermined) {
  put("summary.json",
      R"({"scene": "s", "status": "ok", "mbd_position_error_estimate": "not estimated: too few steps",
      "mbd_undetermined_reactions": [{"joint": "upper <1>", "components": ["force.z"]}]})");
  put("joints.csv",
      "time,upper <1>.q,upper <1>.undetermined,lower.q,lower.undetermined,rod.q,rod.undetermined\n"
      "0,0,4,0,0,0,0\n1,1,5,1,34,1,0\n");
  const std::string text = page();
  for (const char* part :
       {"Reactions that rigid mechanics does not determine",
        "<td>upper &lt;1&gt;</td><td>force.x, force.z</td>", "<td>lower</td><td>force.y, torque.z</td>",
        "<td>not estimated</td>", "\">ok</span>"})
    EXPECT_TRUE(has(text, part)) << part;
  EXPECT_FALSE(has(text, "<td>rod</td>"));
  put("summary.json", R"({"scene": "s", "status": "ok"})");
  put("joints.csv", "time,rod.q,rod.undetermined\n0,0,0\n1,1,0\n");
  EXPECT_FALSE(has(page(), "does not determine"));
}

TEST_F(Report, RunWhoseProcessIsGoneDied) {
  char host[256] = {};
  ASSERT_EQ(gethostname(host, sizeof host - 1), 0);
  put("summary.json", R"({"scene": "s", "status": "running", "process": {"host": ")" + std::string(host) +
                          R"(", "pid": 1, "started": 1}})");
  EXPECT_TRUE(has(page(), "class=\"status bad\">died"));
}

TEST_F(Report, FolderOfNoRunIsAWarning) {
  EXPECT_FALSE(write_report(folder_));
}

}  // namespace
}  // namespace tandem::launch
