// windows.csv: one line per window with what the particles reported and how well the books close so far.
// border.csv: one line per window and body with what crossed between it and the particles.
#pragma once

#include <filesystem>
#include <fstream>

#include "launch/coordinator/coupler.hpp"

namespace tandem::launch {

class WindowLog {
 public:
  WindowLog(const std::filesystem::path& folder, const scene::Scene& scene);
  // The last window.
  void write(const Coupler& coupler);

 private:
  struct File {
    std::filesystem::path path;
    std::ofstream stream;
    explicit File(std::filesystem::path file) : path(std::move(file)), stream(path) {}
    // Whoever looks at a run that goes on, or that was killed, finds its last window. Error{resource} when
    // the disk is full.
    void flush();
  };
  void write_border(const Coupler& coupler);

  const scene::Scene& scene_;
  File windows_, border_;
};

}  // namespace tandem::launch
