// windows.csv: one line per window with what the particles reported and how well the books close so far.
// border.csv: one line per window and body with what crossed between it and the particles.
#pragma once

#include <filesystem>
#include <string>

#include "launch/coordinator/coupler.hpp"
#include "launch/results/row_file.hpp"

namespace tandem::launch {

class WindowLog {
 public:
  WindowLog(const std::filesystem::path& folder, const scene::Scene& scene);
  // The last window.
  void write(const Coupler& coupler);

 private:
  void write_border(const Coupler& coupler);

  const scene::Scene& scene_;
  RowFile windows_, border_;
  std::string rows_;
};

}  // namespace tandem::launch
