#include "coordinator/report/data_folder.hpp"

namespace tandem::launch {

std::filesystem::path data_folder() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return program.parent_path().parent_path() / "share" / "tandem";
}

}  // namespace tandem::launch
