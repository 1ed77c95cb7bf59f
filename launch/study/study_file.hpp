// A study as its file describes it: one scene, the settings that are varied, and the measures of the error.
// docs/study.md is the user's page.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tandem::launch {

// A value of the scene. `name` is its name in the study: "window", or the JSON pointer.
struct Setting {
  std::string name;
  nlohmann::json::json_pointer at;
  nlohmann::json value;
};

struct Sweep {
  std::string name;
  nlohmann::json::json_pointer at;
  std::vector<nlohmann::json> values;
};

struct TableReference {
  std::string source;
  std::vector<double> times;  // [s]
  struct Signal {
    std::string column;
    std::vector<double> values;  // one for each time
  };
  std::vector<Signal> signals;
};
struct RunReference {
  std::vector<Setting> set;
  double every = 0;  // [s]
};
struct FolderReference {
  std::filesystem::path folder;
  double every = 0;  // [s]
};
using Reference = std::variant<std::monostate, TableReference, RunReference, FolderReference>;

struct Measure {
  std::string name;
  std::vector<std::string> of;    // columns of bodies.csv, joints.csv and elements.csv, or one "summary.KEY"
  std::string error = "largest";  // see docs/study.md
  double from = 0;                // [s]
  double expected = 0;            // of summary.KEY
  std::string unit;

  bool of_summary() const { return of.front().starts_with("summary."); }
  // Compares one figure of the whole signal instead of its values over time.
  bool of_figure() const { return error != "largest" && error != "rms" && error != "last"; }
};

struct Study {
  std::string name, description;
  std::filesystem::path file, scene;  // as found from the current folder
  std::vector<Setting> set;
  std::vector<Sweep> sweep;
  std::string order_in;  // name of a sweep; empty: none
  Reference reference;
  std::vector<Measure> measures;
  std::string backend = "cpu";
  int threads = 1;
  int repeat = 1;       // timings of each run, of which the median counts
  double limit = 3600;  // [s]
};

// The published schema (draft 7), compiled into the program.
const std::string& study_schema();

// Throws Error{scene} with the path inside the file.
Study read_study(const std::filesystem::path& path);

// Names of settings that are not JSON pointers.
std::vector<std::string> setting_names();

}  // namespace tandem::launch
