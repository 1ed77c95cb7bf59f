// The ending of a run is in its row; no run is missing in the table.
#include "launch/study/table.hpp"

#include <unistd.h>

#include <cmath>
#include <sstream>

#include "tests/unit/study/study_folder.hpp"

namespace tandem::launch {
namespace {

class Table : public StudyFolderTest {
 protected:
  void SetUp() override {
    StudyFolderTest::SetUp();
    study_ = study();
    plan_ = make_plan(study_);
    truth_ = truth_of_table(std::get<TableReference>(study_.reference));
  }
  Row row(const std::string& name) const { return row_of(plan_.runs[0], folder_ / name, study_, truth_); }

  Study study_;
  Plan plan_;
  Truth truth_;
};

TEST_F(Table, WholeRun) {
  put("r/summary.json", R"({"status": "ok", "mbd_solver_cpu_seconds": 0.25, "dem_solver_cpu_seconds": 0.5})");
  put("r/joints.csv", "time,hinge.q\n0.5,1\n1,2.5\n");
  EXPECT_TRUE(is_complete(folder_ / "r"));
  EXPECT_EQ(row("r").status, "ok");
  EXPECT_EQ(row("r").errors, std::vector<double>{0.5});
  EXPECT_EQ(row("r").cpu, 0.75);
}

TEST_F(Table, DivergedRunIsDoneAndHasNoError) {
  put("r/summary.json",
      R"({"status": "failed", "error": {"code": "numerics", "what": "no convergence, at all"}})");
  put("r/joints.csv", "time,hinge.q\n0.5,1\n");
  EXPECT_TRUE(is_complete(folder_ / "r"));
  EXPECT_EQ(row("r").status, "diverged");
  EXPECT_EQ(row("r").problem, "no convergence, at all");
  EXPECT_TRUE(std::isnan(row("r").errors[0]));
}

TEST_F(Table, OtherEndsAreDoneAgain) {
  put("lost/summary.json", R"({"status": "failed", "error": {"code": "peer_lost", "what": "killed"}})");
  put("lost/joints.csv", "time,hinge.q\n");
  put("half/summary.json", R"({"status": "o)");
  put("crashed.log", "loading\nended by signal 11\n");
  put("slow.log", "stopped at the limit of 5 s\n");
  EXPECT_FALSE(is_complete(folder_ / "lost"));
  EXPECT_FALSE(is_complete(folder_ / "half"));
  EXPECT_EQ(row("lost").status, "failed");
  EXPECT_EQ(row("half").status, "failed");
  EXPECT_EQ(row("half").problem, "it left no summary.json");
  EXPECT_EQ(row("crashed").status, "failed");
  EXPECT_EQ(row("crashed").problem, "ended by signal 11");
  EXPECT_EQ(row("slow").status, "timed_out");
}

// A suspect run is complete: its row counts, and contains the objection of the verdict.
TEST_F(Table, SuspectRunIsMarked) {
  put("r/summary.json",
      R"({"status": "suspect", "verdict": {"lines": [{"sentence": "a"}, {"sentence": "b"}]}})");
  put("r/joints.csv", "time,hinge.q\n0.5,1\n1,2.5\n");
  EXPECT_TRUE(is_complete(folder_ / "r"));
  EXPECT_EQ(row("r").status, "suspect");
  EXPECT_EQ(row("r").problem, "a; b");
  EXPECT_TRUE(counts(row("r"), 0));
}

// Of repeated timings the median counts, and one that died is left out.
TEST_F(Table, TimeIsTheMedianOfItsTimings) {
  study_.repeat = 4;
  const auto timing = [](double seconds) {
    return R"({"status": "ok", "mbd_solver_cpu_seconds": )" + std::to_string(seconds) + "}";
  };
  put("r/summary.json", timing(0.25));
  put("r.2/summary.json", timing(4));
  put("r.3/summary.json", timing(0.5));
  put("r.4/summary.json", R"({"status": "failed", "mbd_solver_cpu_seconds": 0.01})");
  for (const char* folder : {"r", "r.2", "r.3"})
    put(std::string(folder) + "/joints.csv", "time,hinge.q\n0.5,1\n1,2.5\n");
  const Row found = row("r");
  EXPECT_EQ(found.cpu, 0.5);
  EXPECT_EQ(found.cpu_low, 0.25);
  EXPECT_EQ(found.cpu_high, 4);
  EXPECT_EQ(found.errors, std::vector<double>{0.5});
  put("r.4/summary.json", timing(0.75));
  EXPECT_EQ(row("r").cpu, 0.625);
}

TEST_F(Table, SummaryOfTheStartIsNoResult) {
  char host[256] = {};
  ASSERT_EQ(gethostname(host, sizeof host - 1), 0);
  const std::string begun = R"({"status": "running", "process": {"host": ")" + std::string(host) +
                            R"(", "pid": 1, "started": 1}})";  // process 1 has another start
  put("killed/summary.json", begun);
  put("slow/summary.json", begun);
  put("slow.log", "stopped at the limit of 5 s\n");
  EXPECT_FALSE(is_complete(folder_ / "killed"));
  EXPECT_EQ(row("killed").status, "died");
  EXPECT_EQ(row("slow").status, "timed_out");
  EXPECT_TRUE(row("slow").summary.empty());
}

TEST_F(Table, CsvHasARowForEachRun) {
  put("good/summary.json", R"({"status": "ok", "mbd_solver_cpu_seconds": 0.25, "windows": 100})");
  put("good/joints.csv", "time,hinge.q\n0.5,1\n1,2.5\n");
  put("bad/summary.json",
      R"({"status": "failed", "error": {"code": "numerics", "what": "no convergence, at all"}})");
  put("bad/joints.csv", "time,hinge.q\n");
  std::vector<Row> rows{row("good"), row("bad")};
  rows[0].run.key = rows[1].run.key = "k";
  write_table(folder_ / "t.csv", study_, rows);
  std::ostringstream text;
  text << std::ifstream(folder_ / "t.csv").rdbuf();
  EXPECT_EQ(text.str(),
            "window,rho_inf,status,error_angle,front,cpu_s,cpu_low_s,cpu_high_s,mbd_cpu_s,dem_cpu_s,wall_s,"
            "mbd_s,dem_s,exchange_s,"
            "output_s,"
            "simulated_s,windows,micro_steps,mbd_steps,energy_residual,impulse_closure,impulse_outstanding,"
            "momentum_balance,"
            "constraint_violation,max_overlap_ratio,lost_particles,state_hash,run,problem\n"
            "0.01,0.5,ok,0.5,angle,0.25,0.25,0.25,0.25,,,,,,,,100,,,,,,,,,,,k,\n"
            "0.01,0.5,diverged,,,0.0,0.0,0.0,,,,,,,,,,,,,,,,,,,,k,no convergence; at all\n");
}

}  // namespace
}  // namespace tandem::launch
