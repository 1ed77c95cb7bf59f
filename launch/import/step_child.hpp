// Runs tandem_step.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace tandem::launch {

// A folder that is removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The program; empty where this build has none.
std::filesystem::path step_reader();

// Leaves parts.json and the meshes of the STEP file in `folder`. Throws Error with the sentence of
// tandem_step, or because it crashed or took longer than `patience`.
void run_tandem_step(const std::filesystem::path& file, const std::filesystem::path& folder,
                     std::optional<double> deviation, std::chrono::seconds patience);

}  // namespace tandem::launch
