#include "launch/study/table.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "common/file_draft.hpp"
#include "coordinator/run_folder/run_state.hpp"
#include "coordinator/verdict/status.hpp"
#include "launch/study/jobs.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string text(const json& value) {
  if (value.is_null()) return {};
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '\n' || c == '"'; }, ';');
  return text;
}

std::string text(double value) {
  return std::isfinite(value) ? json(value).dump() : std::string();
}

// Keys of summary.json in the table, and the names of their columns.
const std::vector<std::pair<const char*, const char*>>& summary_columns() {
  static const std::vector<std::pair<const char*, const char*>> columns{
      {"mbd_cpu_s", "/mbd_solver_cpu_seconds"},
      {"dem_cpu_s", "/dem_solver_cpu_seconds"},
      {"wall_s", "/wall_s"},
      {"mbd_s", "/time_split/mbd"},
      {"dem_s", "/time_split/dem"},
      {"exchange_s", "/time_split/exchange"},
      {"output_s", "/time_split/output"},
      {"simulated_s", "/simulated_s"},
      {"windows", "/windows"},
      {"micro_steps", "/micro_steps"},
      {"mbd_steps", "/mbd_steps"},
      {"energy_residual", "/energy_residual"},
      {"impulse_closure", "/impulse_closure"},
      {"impulse_outstanding", "/impulse_outstanding"},
      {"momentum_balance", "/momentum_balance"},
      {"constraint_violation", "/constraint_violation"},
      {"max_overlap_ratio", "/max_overlap_ratio"},
      {"lost_particles", "/lost_particles"},
      {"state_hash", "/state_hash"},
  };
  return columns;
}

// The last line of the log of a run without a summary.
std::string last_words(const fs::path& log) {
  std::ifstream file(log);
  std::string line, last;
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

// Processor time of the solvers [s]; infinite where one of them has run and does not report it.
double cost_of(const json& summary) {
  double cost = 0;
  for (const std::string side : {"mbd", "dem"}) {
    const auto time = summary.find(side + "_solver_cpu_seconds"), server = summary.find(side + "_server");
    if (time != summary.end() && time->is_number())
      cost += time->get<double>();
    else if (server != summary.end() && server->is_object())
      cost = std::numeric_limits<double>::infinity();
  }
  return cost;
}

double median(const std::vector<double>& sorted) {
  return 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
}

}  // namespace

bool came_to_its_end(const json& summary) {
  const std::string status = summary.value("status", "");
  return status == name(Status::ok) || status == name(Status::suspect);
}

fs::path timing_folder(const fs::path& folder, int k) {
  return k == 1 ? folder : fs::path(folder.string() + "." + std::to_string(k));
}

bool is_complete(const fs::path& folder) {
  const json summary = read_run(folder).summary;
  return came_to_its_end(summary) || summary.value("/error/code"_json_pointer, "") == "numerics";
}

Row row_of(const PlannedRun& run, const fs::path& folder, const Study& study, const Truth& truth) {
  const RunState state = read_run(folder);
  const std::string& status = state.status;
  Row row{run, "ok", "", {}, 0, state.summary};
  if (row.summary.empty() || status == name(Status::running) || status == name(Status::died)) {
    // The run has not written its ending; the state at its begin is not a result.
    row.problem = last_words(fs::path(folder.string() + ".log"));
    row.status = row.problem.starts_with(stopped_at_limit) ? "timed_out"
                 : row.summary.empty()                     ? name(Status::failed)
                                                           : status;
    if (row.problem.empty())
      row.problem = row.summary.empty() ? "it left no summary.json" : "its program ended without a word";
    row.summary = json::object();
    row.errors.assign(study.measures.size(), std::numeric_limits<double>::quiet_NaN());
    return row;
  }
  if (status == name(Status::suspect)) {
    row.status = status;
    for (const json& line : row.summary.value("/verdict/lines"_json_pointer, json::array()))
      row.problem += (row.problem.empty() ? "" : "; ") + line.value("sentence", "");
  } else if (status != name(Status::ok)) {
    row.status = row.summary.value("/error/code"_json_pointer, "") == "numerics" ? "diverged" : "failed";
    row.problem = row.summary.value("/error/what"_json_pointer, row.summary.value("reason", status));
  }
  std::vector<double> times{cost_of(row.summary)};
  for (int k = 2; k <= study.repeat; ++k)
    if (const json again = read_run(timing_folder(folder, k)).summary; came_to_its_end(again))
      times.push_back(cost_of(again));
  std::ranges::sort(times);
  row.cpu = median(times), row.cpu_low = times.front(), row.cpu_high = times.back();
  row.errors = errors_of_run(folder, row.summary, study.measures, truth);
  return row;
}

void write_table(const fs::path& file, const Study& study, const std::vector<Row>& rows) {
  std::vector<std::vector<std::size_t>> fronts;
  for (std::size_t m = 0; m < study.measures.size(); ++m) fronts.push_back(pareto_front(rows, m));

  std::ostringstream out;
  for (const Sweep& sweep : study.sweep) out << sweep.name << ',';
  out << "status";
  for (const Measure& measure : study.measures) out << ",error_" << measure.name;
  out << ",front,cpu_s,cpu_low_s,cpu_high_s";
  for (const auto& [name, at] : summary_columns()) out << ',' << name;
  out << ",run,problem\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    for (const Setting& setting : row.run.settings) out << text(setting.value) << ',';
    out << row.status;
    for (const double error : row.errors) out << ',' << text(error);
    std::string front;  // measures for which the run is on the front
    for (std::size_t m = 0; m < fronts.size(); ++m)
      if (std::find(fronts[m].begin(), fronts[m].end(), i) != fronts[m].end())
        front += (front.empty() ? "" : " ") + study.measures[m].name;
    out << ',' << front;
    for (const double time : {row.cpu, row.cpu_low, row.cpu_high})
      out << ',' << (row.summary.empty() ? "" : text(time));
    for (const auto& [name, at] : summary_columns()) {
      const json::json_pointer pointer(at);
      out << ',' << (row.summary.contains(pointer) ? text(row.summary.at(pointer)) : "");
    }
    out << ',' << row.run.key << ',' << text(json(row.problem)) << '\n';
  }
  replace_file(file, out.str());
}

}  // namespace tandem::launch
