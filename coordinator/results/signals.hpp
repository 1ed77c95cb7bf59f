// Time signals of a run, one row per window end, stored in a CSV file only: the memory of a run does not grow
// with its windows.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "coordinator/results/row_file.hpp"

namespace tandem::launch {

class Signals {
 public:
  // Columns are fixed at construction; the first is "time" [s]. Rows are written to `file` immediately.
  Signals(const std::filesystem::path& file, std::vector<std::string> columns);
  void append(const std::vector<double>& row);

  bool has(const std::string& column) const;
  const std::vector<std::string>& names() const { return names_; }
  const std::filesystem::path& file() const { return file_.path(); }
  std::uint64_t rows() const { return file_.end().lines - 1; }

  // Calls `take` with the values of these columns, row by row from the first, read back from the file
  // without loss. Throws Error{scene} with the nearest name for an unknown column; Error{resource} where
  // the file has been changed.
  void visit(const std::vector<std::string>& columns,
             const std::function<void(std::span<const double>)>& take) const;

  // The present end of the rows; and copying of the rows of an earlier part of the same run up to such a
  // mark.
  const RowMark& mark() const { return file_.end(); }
  void begin_with(const std::filesystem::path& earlier, const RowMark& mark) {
    file_.begin_with(earlier, mark);
  }
  void flush_to_disk() const { file_.flush_to_disk(); }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> index_;
  RowFile file_;
  std::string line_;
};

}  // namespace tandem::launch
