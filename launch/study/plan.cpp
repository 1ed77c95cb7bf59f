#include "launch/study/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/implicit_settings.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parameters.hpp"
#include "common/scene/parse.hpp"
#include "common/time.hpp"
#include "common/utf8.hpp"
#include "coordinator/scene/scene_paths.hpp"
#include "launch/study/explicit_method.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A scene, or a file that it names.
std::string content(const fs::path& path) {
  return read_input(path, {.largest = largest_particle_file, .hint = "check the path"});
}

// FNV-1a, 64 bits.
std::string hash(const std::vector<std::string>& texts) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::string& text : texts) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    hash = (hash ^ 0xffu) * 0x100000001b3u;  // not a byte of UTF-8: separates the texts
  }
  return fmt::format("{:016x}", hash);
}

class Planner {
 public:
  Planner(const Study& study, const std::vector<std::string>& servers,
          const std::map<std::string, double>& set)
      : study_(study),
        servers_(servers),
        folder_(study.scene.parent_path()),
        base_(parse_base(study.scene, set)) {}

  Plan plan() {
    Plan plan;
    std::vector<Setting> settings;
    combine(0, settings, plan.runs);
    const auto* table = std::get_if<TableReference>(&study_.reference);
    const auto* run = std::get_if<RunReference>(&study_.reference);
    const auto* earlier = std::get_if<FolderReference>(&study_.reference);
    if (run) plan.reference = planned(run->set, "reference");
    if (table) plan.times = table->times;
    if (run || earlier) plan.times = multiples(run ? run->every : earlier->every);
    for (const PlannedRun& planned : plan.runs) check_times(planned, planned.label(), plan.times);
    if (plan.reference) check_times(*plan.reference, "reference", plan.times);
    const scene::Scene scene = scene::parse(base_.dump(), study_.scene.string());
    plan.try_explicit_method =
        scene.mbd && scene.mbd->server.empty() && (servers_.empty() || servers_.front().empty()) &&
        scene.mbd->integrator.method == scene::IntegrationMethod::generalized_alpha &&
        suits_explicit_method(*scene.mbd) &&
        std::ranges::none_of(plan.runs, [](const PlannedRun& each) { return method_of(each).has_value(); });
    return plan;
  }

 private:
  static json parse_base(const fs::path& path, const std::map<std::string, double>& set) {
    std::string text = content(path);
    scene::put_in_parameters(text, set, path.string());
    scene::validate(scene::parse(text, path.string()), path.string());
    json scene = json::parse(text);
    // Outputs do not affect the computation, and may not fit every window.
    scene.erase("output");
    scene.erase("checks");
    return scene;
  }

  void combine(std::size_t depth, std::vector<Setting>& settings, std::vector<PlannedRun>& runs) const {
    if (depth == study_.sweep.size()) {
      runs.push_back(planned(settings, ""));
      return;
    }
    const Sweep& sweep = study_.sweep[depth];
    for (const json& value : sweep.values) {
      settings.push_back({sweep.name, sweep.at, value});
      combine(depth + 1, settings, runs);
      settings.pop_back();
    }
  }

  PlannedRun planned(const std::vector<Setting>& settings, const std::string& label) const {
    PlannedRun run{settings, {}, {}};
    const std::string place = study_.file.string() + ": run " + (label.empty() ? run.label() : label);
    json scene = base_;
    // Only settings of the study itself contradict the method that it sets.
    if (method_of(run) == scene::IntegrationMethod::dormand_prince && scene["mbd"].contains("integrator"))
      for (const char* key : scene::implicit_settings) scene["mbd"]["integrator"].erase(key);
    for (const auto* list : {&study_.set, &settings})
      for (const Setting& setting : *list) apply(setting, scene, place);
    try {
      const scene::Scene parsed = scene::parse(scene.dump(), study_.scene.string());
      scene::validate(parsed, study_.scene.string());
      scene::validate_files(parsed, study_.scene.string(), folder_);
      check_columns(parsed);
    } catch (const Error& error) {
      throw Error(error.code(), error.problem(), place + ": " + error.where(), error.hint());
    }
    std::vector<std::string> parts;
    for_each_file(scene, [&](json& name) {
      const fs::path path = fs::absolute(scene::resolve_file(name.get<std::string>(), folder_));
      parts.push_back(content(path));
      name = path.string();
    });
    make_other_paths_absolute(scene, folder_);  // the scene of a run is in another folder
    run.scene = scene.dump(1);
    parts.insert(parts.end(), {run.scene, study_.backend, std::to_string(study_.threads)});
    if (std::ranges::any_of(servers_, [](const std::string& server) { return !server.empty(); }))
      parts.insert(parts.end(), servers_.begin(), servers_.end());
    run.key = hash(parts);
    return run;
  }

  static void apply(const Setting& setting, json& scene, const std::string& place) {
    try {
      scene[setting.at] = setting.value;
    } catch (const json::exception&) {
      throw Error(ErrorCode::scene,
                  "the scene has no place '" + shortened(setting.at.to_string()) + "' for a value", place,
                  "check the pointer; lists are numbered from 0");
    }
  }

  void check_columns(const scene::Scene& scene) const {
    const std::vector<std::string> known = scene::all_columns(scene);
    for (const Measure& measure : study_.measures) {
      if (measure.of_summary()) continue;
      for (const std::string& column : measure.of)
        if (std::find(known.begin(), known.end(), column) == known.end())
          throw Error(ErrorCode::scene, "there is no signal '" + shortened(column) + "'",
                      "measure '" + measure.name + "'", suggest_name(column, known, "signals"));
    }
  }

  std::vector<double> multiples(double every) const {
    json scene = base_;
    for (const Setting& setting : study_.set) apply(setting, scene, study_.file.string());
    const double end = scene.at("end_time");
    std::vector<double> times;
    for (int i = 1; i * every <= end * (1 + 1e-12); ++i) times.push_back(i * every);
    if (times.empty())
      throw Error(ErrorCode::scene, fmt::format("{:.6g} s is longer than the run of {:.6g} s", every, end),
                  study_.file.string() + ": reference.every", "give a shorter time");
    return times;
  }

  // A signal is unknown between the ends of windows: interpolation would add an error of its own.
  void check_times(const PlannedRun& run, const std::string& label, const std::vector<double>& times) const {
    const json scene = json::parse(run.scene);
    const double window = scene.value(json::json_pointer("/coupling/window"), 1e-3);
    const double end = scene.at("end_time");
    for (const double time : times)
      if (to_nanoseconds(time).count % to_nanoseconds(window).count != 0 || time > end * (1 + 1e-12))
        throw Error(
            ErrorCode::scene,
            time > end * (1 + 1e-12) ? fmt::format("it ends at {:.10g} s, before {:.10g} s", end, time)
                                     : fmt::format("no window of {:.10g} s ends at {:.10g} s", window, time),
            study_.file.string() + ": run " + label, "choose windows that divide the times of the reference");
  }

  const Study& study_;
  const std::vector<std::string>& servers_;
  const fs::path folder_;
  const json base_;
};

}  // namespace

std::string PlannedRun::label() const {
  std::string label;
  for (const Setting& setting : settings) {
    label += (label.empty() ? "" : " ") + setting.name + "=";
    label += setting.value.is_string() ? setting.value.get<std::string>() : setting.value.dump();
  }
  return label;
}

Plan make_plan(const Study& study, const std::vector<std::string>& servers,
               const std::map<std::string, double>& set) {
  return Planner(study, servers, set).plan();
}

}  // namespace tandem::launch
