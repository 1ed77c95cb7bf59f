#include "coordinator/report/report.hpp"

#include "coordinator/report/data_folder.hpp"
#include "coordinator/report/tool.hpp"

namespace tandem::launch {

bool write_report(const std::filesystem::path& folder) {
  const std::filesystem::path log_file = std::filesystem::absolute(folder / "report.log");
  // Debian's Python, for which the package list installs matplotlib; another one on PATH may lack it.
  return run_tool({.program = "/usr/bin/python3",
                   .package = "python3 python3-matplotlib",
                   .arguments = {(data_folder() / "report.py").string(), "."},
                   .folder = folder,
                   .log = log_file,
                   .patience = std::chrono::seconds(120)});
}

}  // namespace tandem::launch
