#include "launch/results/signals.hpp"

#include <cerrno>
#include <charconv>
#include <system_error>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "launch/results/disk_error.hpp"

namespace tandem::launch {
namespace {

// Shortest text that reads back as the same double.
void append_number(std::string& line, double value) {
  char text[32];
  const auto [end, status] = std::to_chars(text, text + sizeof text, value);
  line.append(text, end);
}

}  // namespace

Signals::Signals(const std::filesystem::path& file, std::vector<std::string> columns)
    : path_(file), file_(file), names_(std::move(columns)), columns_(names_.size()) {
  if (!file_) fail_on_disk(path_, "cannot make the file: " + std::generic_category().message(errno));
  std::string header;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (!index_.emplace(names_[i], i).second) {
      throw Error(ErrorCode::internal, "column \"" + names_[i] + "\" twice", path_.string());
    }
    header += (i == 0 ? "" : ",") + names_[i];
  }
  file_ << header << '\n' << std::flush;
}

void Signals::append(const std::vector<double>& row) {
  if (row.size() != columns_.size()) {
    throw Error(ErrorCode::internal,
                "a row of " + std::to_string(row.size()) + " values for " + std::to_string(columns_.size()) +
                    " columns",
                path_.string());
  }
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    columns_[i].push_back(row[i]);
    if (i > 0) line += ',';
    append_number(line, row[i]);
  }
  line += '\n';
  // Flushed, so that the rows of a run that dies are there.
  if (!(file_ << line << std::flush))
    fail_on_disk(path_, "cannot write: " + std::generic_category().message(errno));
}

std::vector<double> Signals::rows() const {
  std::vector<double> rows;
  const std::size_t count = columns_.front().size();
  rows.reserve(count * columns_.size());
  for (std::size_t i = 0; i < count; ++i)
    for (const std::vector<double>& column : columns_) rows.push_back(column[i]);
  return rows;
}

void Signals::begin_with(const std::vector<double>& rows) {
  if (rows.size() % columns_.size() != 0)
    throw Error(ErrorCode::resource,
                "rows of " + std::to_string(columns_.size()) + " columns do not make " +
                    std::to_string(rows.size()) + " values",
                path_.string());
  for (auto row = rows.begin(); row != rows.end(); row += std::ssize(columns_))
    append({row, row + std::ssize(columns_)});
}

bool Signals::has(const std::string& column) const {
  return index_.contains(column);
}

const std::vector<double>& Signals::column(const std::string& name) const {
  const auto found = index_.find(name);
  if (found == index_.end()) {
    throw Error(ErrorCode::scene, "there is no signal \"" + name + "\"", path_.filename().string(),
                suggest_name(name, names_, "signals"));
  }
  return columns_[found->second];
}

}  // namespace tandem::launch
