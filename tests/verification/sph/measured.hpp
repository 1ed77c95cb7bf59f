// Measurements with which runs are compared. The environment variable TANDEM_SHARED_DATA names another
// folder.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace tandem::test {

// Rows of numbers of a file of measurements beside the project, without its line of names; empty where it is
// absent.
inline std::vector<std::vector<double>> measured_rows(const std::string& name) {
  const char* const elsewhere = std::getenv("TANDEM_SHARED_DATA");
  std::ifstream file(std::string(elsewhere ? elsewhere : SHARED_DATA) + "/" + name);
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
