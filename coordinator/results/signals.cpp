#include "coordinator/results/signals.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "coordinator/results/disk_error.hpp"

namespace tandem::launch {
namespace {

// Shortest text that is read back as the same double.
void append_number(std::string& line, double value) {
  char text[32];
  const auto [end, status] = std::to_chars(text, text + sizeof text, value);
  line.append(text, end);
}

}  // namespace

Signals::Signals(const std::filesystem::path& file, std::vector<std::string> columns)
    : names_(std::move(columns)), file_(file, fmt::format("{}", fmt::join(names_, ","))) {
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (!index_.emplace(names_[i], i).second)
      throw Error(ErrorCode::internal, "column \"" + names_[i] + "\" twice", file.string());
}

void Signals::append(const std::vector<double>& row) {
  if (row.size() != names_.size()) {
    throw Error(ErrorCode::internal,
                "a row of " + std::to_string(row.size()) + " values for " + std::to_string(names_.size()) +
                    " columns",
                file_.path().string());
  }
  line_.clear();
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) line_ += ',';
    append_number(line_, row[i]);
  }
  line_ += '\n';
  file_.append(line_);
}

bool Signals::has(const std::string& column) const {
  return index_.contains(column);
}

void Signals::visit(const std::vector<std::string>& columns,
                    const std::function<void(std::span<const double>)>& take) const {
  // Index of each wanted value and of its column in the file, in the order of the file.
  std::vector<std::pair<std::size_t, std::size_t>> wanted;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto found = index_.find(columns[i]);
    if (found == index_.end())
      throw Error(ErrorCode::scene, "there is no signal \"" + columns[i] + "\"",
                  file_.path().filename().string(), suggest_name(columns[i], names_, "signals"));
    wanted.emplace_back(found->second, i);
  }
  std::sort(wanted.begin(), wanted.end());

  std::ifstream file(file_.path(), std::ios::binary);
  std::string line;
  std::getline(file, line);  // the names
  std::vector<double> values(columns.size());
  for (std::uint64_t row = 0; row < rows(); ++row) {
    const auto fail = [&] {
      fail_on_disk(file_.path(), "row " + std::to_string(row + 1) + " cannot be read back");
    };
    if (!std::getline(file, line)) fail();
    const char *at = line.data(), *const end = at + line.size();
    std::size_t column = 0;
    for (const auto& [place, value] : wanted) {
      for (; column < place && at != end; ++column) {
        at = std::find(at, end, ',');
        if (at != end) ++at;
      }
      if (std::from_chars(at, end, values[value]).ec != std::errc()) fail();
    }
    take(values);
  }
}

}  // namespace tandem::launch
