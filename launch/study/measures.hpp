// Errors of a run against the reference.
#pragma once

#include "launch/study/signal_file.hpp"
#include "launch/study/study_file.hpp"

namespace tandem::launch {

// The reference that runs are compared with.
struct Truth {
  std::vector<double> times;                           // at which signals are compared [s]
  std::map<std::string, std::vector<double>> signals;  // by column, one value for each time
  SignalSet whole;  // of a reference that is a run; for figures of a signal
};

Truth truth_of_table(const TableReference& table);
Truth truth_of_run(const std::filesystem::path& folder, const std::vector<Measure>& measures,
                   const std::vector<double>& times);

// One value for each measure; NaN where the run ended before the last of the times, or lacks the value.
std::vector<double> errors_of_run(const std::filesystem::path& folder, const nlohmann::json& summary,
                                  const std::vector<Measure>& measures, const Truth& truth);

}  // namespace tandem::launch
