// Time signals of a finished run, read back from bodies.csv, joints.csv, elements.csv and sensors.csv.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tandem::launch {

struct SignalSet {
  std::vector<double> time;                           // ends of windows [s]
  std::map<std::string, std::vector<double>> column;  // in the unit of the signal, one value for each time
};

// The requested columns, from the files of `folder` that have them. A row that a crash has truncated is left
// out. Throws Error{resource} where a column is in no file.
SignalSet read_signals(const std::filesystem::path& folder, const std::vector<std::string>& columns);

}  // namespace tandem::launch
