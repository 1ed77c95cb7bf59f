// Measurements with which runs are compared.
#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace tandem::test {

// Rows of numbers of a file of measurements beside the project, without its line of names; empty where it is
// absent.
inline std::vector<std::vector<double>> measured_rows(const std::string& name) {
  std::ifstream file(std::string(SHARED_DATA) + "/" + name);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream text(line);
    std::vector<double>& row = rows.emplace_back();
    for (double value = 0; text >> value;) row.push_back(value);
  }
  return rows;
}

}  // namespace tandem::test
