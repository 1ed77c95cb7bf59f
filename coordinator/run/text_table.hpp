// Tables of text.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/math/vec3.hpp"

namespace tandem::launch::tables {

inline std::string text(Vec3d v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z);
}

// Left-aligned columns as wide as their widest cell.
class Table {
 public:
  explicit Table(std::string title, std::vector<std::string> head)
      : title_(std::move(title)), rows_{std::move(head)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string print() const {
    if (rows_.size() == 1) return {};
    std::vector<std::size_t> width(rows_[0].size());
    for (const auto& row : rows_)
      for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    std::string out = "\n" + title_ + "\n";
    for (const auto& row : rows_) {
      std::string line = " ";
      for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format(" {:<{}}", row[i], width[i]);
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
    return out;
  }

 private:
  std::string title_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tandem::launch::tables
