#include "launch/study/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <thread>

#include "common/cores.hpp"
#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "common/interrupt.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse.hpp"
#include "common/utf8.hpp"
#include "coordinator/report/data_folder.hpp"
#include "coordinator/report/tool.hpp"
#include "coordinator/run_folder/claimed_folder.hpp"
#include "coordinator/run_folder/run_state.hpp"
#include "coordinator/start/server_command.hpp"
#include "coordinator/verdict/status.hpp"
#include "launch/study/jobs.hpp"
#include "launch/study/reading_text.hpp"
#include "launch/study/table.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Wish {
  std::size_t measure;
  double error;
};

std::vector<Wish> wishes_of(const std::vector<std::string>& texts, const Study& study) {
  std::vector<std::string> names;
  for (const Measure& measure : study.measures) names.push_back(measure.name);
  std::vector<Wish> wishes;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    const std::string name = text.substr(0, sign),
                      value = sign == std::string::npos ? "" : text.substr(sign + 1);
    const auto measure = std::find(names.begin(), names.end(), name);
    if (measure == names.end())
      throw Error(ErrorCode::usage, "there is no measure '" + shortened(name) + "'", "--want",
                  suggest_name(name, names, "measures"));
    double error = 0;
    const auto [end, status] = std::from_chars(value.data(), value.data() + value.size(), error);
    if (status != std::errc{} || end != value.data() + value.size() || !(error > 0))
      throw Error(ErrorCode::usage, "'" + shortened(value) + "' is no error > 0", "--want",
                  "give for instance " + name + "=1e-3");
    wishes.push_back({static_cast<std::size_t>(measure - names.begin()), error});
  }
  return wishes;
}

std::vector<std::string> server_arguments(const StudyOptions& options) {
  std::vector<std::string> arguments;
  if (options.mbd_server) arguments.insert(arguments.end(), {"--mbd-server", *options.mbd_server});
  if (options.dem_server) arguments.insert(arguments.end(), {"--dem-server", *options.dem_server});
  if (options.sph_server) arguments.insert(arguments.end(), {"--sph-server", *options.sph_server});
  if (options.allow_scene_servers) arguments.emplace_back("--allow-scene-servers");
  return arguments;
}

// Refuses before the first run what each of them would refuse.
void expect_servers(const Study& study, const Plan& plan, const StudyOptions& options) {
  RunOptions of_run;
  of_run.mbd_server = options.mbd_server;
  of_run.dem_server = options.dem_server;
  of_run.sph_server = options.sph_server;
  of_run.allow_scene_servers = options.allow_scene_servers;
  for (const PlannedRun& run : plan.runs) {
    SceneFile file;
    file.origin = study.scene.string();
    file.scene = scene::parse(run.scene, file.origin);
    foreign_servers(file, of_run);
  }
}

void expect_no_interrupt(const fs::path& folder) {
  if (interrupted())
    throw Error(ErrorCode::interrupted, "the study was interrupted", folder.string(),
                "the same command continues where it stopped");
}

// A run of an earlier call that goes on would refuse its folder to the new one.
void expect_no_run_in(const fs::path& folder) {
  const RunState there = read_run(folder);
  if (there.status == name(Status::running))
    throw Error(ErrorCode::usage,
                fmt::format("a run of this study is still in progress: pid {} on {}",
                            there.marker ? there.marker->pid : 0, there.marker ? there.marker->host : "?"),
                folder.string(), "wait for its end, or end it: tandem stop " + folder.string());
}

// Whether the study lacks the row's result: the same command runs it again.
bool is_missing(const Row& row) {
  return row.status == name(Status::died) || row.status == name(Status::running) ||
         row.status == name(Status::failed);
}

// A run that is to be done, for the k-th time.
struct Timing {
  const PlannedRun* run;
  std::filesystem::path folder;
  int k;
};

class StudyFolder {
 public:
  StudyFolder(const Study& study, const StudyOptions& options)
      : study_(study), folder_(options.folder), arguments_(server_arguments(options)) {
    claim_folder(folder_,
                 {"study",
                  {"scenes", "runs", "results.csv", "reading.txt", "plot.json", "plot.log", "study.png"},
                  {study.file, study.scene}});
    std::error_code error;
    for (const char* name : {"scenes", "runs"}) fs::create_directories(folder_ / name, error);
    if (error)
      throw Error(ErrorCode::resource, "cannot be created: " + error.message(), folder_.string(),
                  "give another --out");
    const int cores = static_cast<int>(usable_cores());
    jobs_ = options.jobs > 0 ? options.jobs : std::max(1, cores / study.threads);
  }

  fs::path results(const PlannedRun& run) const { return folder_ / "runs" / run.key; }

  // Runs the missing runs.
  void complete(const Plan& plan) const {
    std::vector<Timing> missing;
    std::set<fs::path> known;
    std::size_t all = 0;
    const auto want = [&](const PlannedRun& run, int k) {
      const fs::path folder = timing_folder(results(run), k);
      if (!known.insert(folder).second) return;  // the reference may be one of the runs
      // What did not come to its end once has no time to be measured again.
      if (k > 1 && is_complete(results(run)) && !came_to_its_end(read_run(results(run)).summary)) return;
      ++all;
      if (!is_complete(folder)) missing.push_back({&run, folder, k});
    };
    // The reference usually takes longest: it starts first, so that it does not run alone at the end.
    if (plan.reference) want(*plan.reference, 1);
    // One timing of all runs after the other, so that a disturbance of the machine is in one timing of each.
    for (int k = 1; k <= study_.repeat; ++k)
      for (const PlannedRun& run : plan.runs) want(run, k);
    fmt::print("{}: {} runs, {} of them done before, {} side by side\n", study_.name, all,
               all - missing.size(), jobs_);
    std::fflush(stdout);

    for (const Timing& timing : missing) expect_no_run_in(timing.folder);
    std::vector<Job> jobs;
    for (const Timing& timing : missing) {
      const fs::path scene = folder_ / "scenes" / (timing.run->key + ".json");
      replace_file(scene, timing.run->scene + '\n');
      jobs.push_back({scene, timing.folder, study_.backend, study_.threads, study_.limit, arguments_});
    }
    std::size_t finished = all - missing.size();
    run_jobs(jobs, jobs_, [&](std::size_t i, double seconds) {
      expect_no_interrupt(folder_);
      auto [marker, summary, status] = read_run(jobs[i].folder);
      if (status.empty()) status = name(Status::failed);
      if (status == name(Status::died) && seconds >= study_.limit) status = "timed out";
      if (summary.value("reason", "") == reason_interrupted)
        throw Error(ErrorCode::interrupted, "the study was interrupted", folder_.string(),
                    "the same command continues where it stopped");
      const Timing& timing = missing[i];
      const std::string label =
          timing.run == (plan.reference ? &*plan.reference : nullptr) ? "reference" : timing.run->label();
      const std::string again = timing.k > 1 ? fmt::format(" (timing {})", timing.k) : "";
      fmt::print("[{}/{}] {}{}: {}, {:.1f} s\n", ++finished, all, label, again, status, seconds);
      std::fflush(stdout);
    });
    expect_no_interrupt(folder_);
  }

  Truth truth(const Plan& plan) const {
    if (const auto* table = std::get_if<TableReference>(&study_.reference)) return truth_of_table(*table);
    if (const auto* earlier = std::get_if<FolderReference>(&study_.reference))
      return truth_of_run(earlier->folder, study_.measures, plan.times);
    if (!plan.reference) return {};
    const json summary = read_run(results(*plan.reference)).summary;
    if (!came_to_its_end(summary))
      throw Error(ErrorCode::numerics,
                  "the reference run has not come to its end: " +
                      summary.value("/error/what"_json_pointer, "it left no summary.json"),
                  results(*plan.reference).string(), "choose settings of reference.set that run");
    return truth_of_run(results(*plan.reference), study_.measures, plan.times);
  }

  std::vector<Row> rows(const Plan& plan) const {
    const Truth truth = this->truth(plan);
    std::vector<Row> rows;
    for (const PlannedRun& run : plan.runs) rows.push_back(row_of(run, results(run), study_, truth));
    write_table(folder_ / "results.csv", study_, rows);
    return rows;
  }

  void say(const std::string& reading) const {
    replace_file(folder_ / "reading.txt", reading);
    fmt::print("\n{}", reading);
  }

  // Draws study.png; returns false after a warning where that failed.
  bool plot(const std::vector<Wish>& wishes) const {
    json measures = json::array(), settings = json::array();
    for (const Measure& measure : study_.measures)
      measures.push_back({{"name", measure.name}, {"unit", measure.unit}});
    for (const Wish& wish : wishes) measures[wish.measure]["want"] = wish.error;
    for (const Sweep& sweep : study_.sweep) settings.push_back(sweep.name);
    const json plot{{"name", study_.name},
                    {"measures", measures},
                    {"settings", settings},
                    {"line", study_.order_in},
                    {"repeat", study_.repeat}};
    replace_file(folder_ / "plot.json", plot.dump(1));
    fs::remove(folder_ / "study.png");  // no outdated figure with new results
    return run_tool({.program = "/usr/bin/python3",
                     .package = "python3 python3-matplotlib",
                     .arguments = {(data_folder() / "study.py").string(), "."},
                     .folder = folder_,
                     .log = fs::absolute(folder_ / "plot.log"),
                     .patience = std::chrono::seconds(120)});
  }

 private:
  const Study& study_;
  const fs::path folder_;
  const std::vector<std::string> arguments_;  // of each `tandem run`
  int jobs_ = 1;
};

}  // namespace

int study(const StudyOptions& options) {
  const Study study = read_study(options.file);
  const std::vector<Wish> wishes = wishes_of(options.want, study);
  const Plan plan =
      make_plan(study, {options.mbd_server.value_or(""), options.dem_server.value_or("")}, options.set);
  expect_servers(study, plan, options);
  const InterruptGuard guard;
  const StudyFolder folder(study, options);
  folder.complete(plan);
  const std::vector<Row> rows = folder.rows(plan);
  folder.say(reading_of(study, plan, rows));
  const bool drawn = folder.plot(wishes);
  expect_no_interrupt(options.folder);

  int status = 0;
  if (const auto missing = std::ranges::count_if(rows, is_missing); missing > 0) {
    fmt::print(
        "\n{} of {} runs have no result, as they died or failed: the column problem of results.csv says why; "
        "the same command repeats them\n",
        missing, rows.size());
    status = 1;
  }
  for (const Wish& wish : wishes) {
    const std::string& name = study.measures[wish.measure].name;
    if (const auto best = cheapest(rows, wish.measure, wish.error)) {
      fmt::print("\ncheapest with {} <= {:.6g}: {}", name, wish.error, row_text(rows[*best], wish.measure));
      continue;
    }
    const auto front = pareto_front(rows, wish.measure);
    fmt::print("\nno setting has {} <= {:.6g}; {}", name, wish.error,
               front.empty() ? "no run came to its end\n"
                             : "the best: " + row_text(rows[front.back()], wish.measure));
    status = 1;
  }
  fmt::print("\nresults in {}: results.csv, reading.txt{}\n", options.folder.string(),
             drawn ? ", study.png" : "; study.png could not be drawn (see the warning above)");
  return status;
}

}  // namespace tandem::launch
