// windows.csv: one line per window with the particles' figures and the residuals of the balances so far.
// border.csv: one line per window and body with its exchange with the particles.
#pragma once

#include <filesystem>
#include <string>

#include "coordinator/results/row_file.hpp"
#include "coordinator/window/coupler.hpp"

namespace tandem::launch {

class WindowLog {
 public:
  WindowLog(const std::filesystem::path& folder, const scene::Scene& scene);
  // Writes the lines of the last window.
  void write(const Coupler& coupler);

 private:
  void write_interface(const Coupler& coupler);

  const scene::Scene& scene_;
  RowFile windows_, interface_;
  std::string rows_;
};

}  // namespace tandem::launch
