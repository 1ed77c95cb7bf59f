// windows.csv: one line per window with what the particles reported and how well the books close so far.
#pragma once

#include <filesystem>
#include <fstream>

#include "launch/coordinator/accounts.hpp"

namespace tandem::launch {

class WindowLog {
 public:
  explicit WindowLog(const std::filesystem::path& file);
  void write(const Window& window, const Accounts& accounts);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace tandem::launch
