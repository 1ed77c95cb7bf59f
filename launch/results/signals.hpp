// Time signals of a run, one row per window end, kept in memory for the checks and streamed to CSV files.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <unordered_map>
#include <vector>

namespace tandem::launch {

class Signals {
 public:
  // Columns are fixed at construction; the first is "time" [s]. Rows go to `file` as they come.
  Signals(const std::filesystem::path& file, std::vector<std::string> columns);
  void append(const std::vector<double>& row);

  // All rows, one after the other; and those of an earlier part of the same run, before the first append().
  std::vector<double> rows() const;
  void begin_with(const std::vector<double>& rows);

  bool has(const std::string& column) const;
  const std::vector<double>& column(const std::string& name) const;  // Error{scene} with the nearest name
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> index_;
  std::vector<std::vector<double>> columns_;
};

}  // namespace tandem::launch
