// Time signals of a run, one row per window end, in a CSV file. They are kept there alone: the memory of a
// run does not grow with its windows.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "launch/results/row_file.hpp"

namespace tandem::launch {

class Signals {
 public:
  // Columns are fixed at construction; the first is "time" [s]. Rows go to `file` as they come.
  Signals(const std::filesystem::path& file, std::vector<std::string> columns);
  void append(const std::vector<double>& row);

  bool has(const std::string& column) const;
  const std::vector<std::string>& names() const { return names_; }
  std::uint64_t rows() const { return file_.end().lines - 1; }

  // Calls `take` with the values of these columns, row by row from the first, as they are read back from the
  // file: to the bit. Error{scene} with the nearest name for an unknown column; Error{resource} where the
  // file is not as it was written.
  void visit(const std::vector<std::string>& columns,
             const std::function<void(std::span<const double>)>& take) const;

  // Where the rows end now; and the rows of an earlier part of the same run, up to such a mark of its file.
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
