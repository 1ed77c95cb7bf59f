#include "launch/study/signal_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {
namespace {

// Rows are read one at a time, so that the limit is only one against a file without an end.
constexpr std::uint64_t largest_rows = std::uint64_t{1} << 50;  // [bytes]

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    cells.push_back(line.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

double number(std::string_view cell, const std::filesystem::path& file) {
  double value = 0;
  const auto [end, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (status != std::errc{} || end != cell.data() + cell.size())
    throw Error(ErrorCode::resource, "'" + shortened(cell) + "' is no number", file.string());
  return value;
}

// Adds those of `columns` that are in the file to `set`.
void read(const std::filesystem::path& file, const std::vector<std::string>& columns, SignalSet& set) {
  if (!std::filesystem::exists(file)) return;  // a scene may have no joints, elements or sensors
  expect_input(file, {.code = ErrorCode::resource, .largest = largest_rows});
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return;
  std::vector<std::string> names;
  for (const std::string_view cell : split(line)) names.emplace_back(cell);
  std::vector<std::pair<std::size_t, std::vector<double>*>> wanted;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(columns.begin(), columns.end(), names[i]) != columns.end())
      wanted.emplace_back(i, &set.column[names[i]]);
  if (wanted.empty()) return;
  std::vector<double> time;
  while (std::getline(stream, line)) {
    const auto cells = split(line);
    if (cells.size() != names.size() || stream.eof()) break;  // each complete row ends with a line break
    time.push_back(number(cells[0], file));
    for (const auto& [i, values] : wanted) values->push_back(number(cells[i], file));
  }
  // These files have one row per window; after a crash one of them may lack the last row.
  if (set.time.empty() || time.size() < set.time.size()) set.time = std::move(time);
}

}  // namespace

SignalSet read_signals(const std::filesystem::path& folder, const std::vector<std::string>& columns) {
  SignalSet set;
  for (const char* name : {"bodies.csv", "joints.csv", "elements.csv", "sensors.csv"})
    read(folder / name, columns, set);
  for (const std::string& column : columns)
    if (!set.column.contains(column))
      throw Error(ErrorCode::resource, "no file of the run holds the signal '" + shortened(column) + "'",
                  folder.string());
  for (auto& [name, values] : set.column) values.resize(std::min(values.size(), set.time.size()));
  return set;
}

}  // namespace tandem::launch
