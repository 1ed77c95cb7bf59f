#include "common/control_groups.hpp"

#include <fstream>

namespace tandem {

namespace fs = std::filesystem;

void for_each_control_group(const fs::path& root, const std::string& controller,
                            const std::function<void(const fs::path& folder)>& f) {
  const fs::path mount = root / "sys/fs/cgroup" / controller;
  std::ifstream groups(root / "proc/self/cgroup");
  // "0::/path" of version 2, "4:cpu,memory:/path" of version 1.
  for (std::string line; std::getline(groups, line);) {
    const std::size_t kinds = line.find(':') + 1, path = line.find(':', kinds) + 1;
    if (kinds == 0 || path == 0) continue;
    const std::string kind = "," + line.substr(kinds, path - 1 - kinds) + ",";
    if (kind.find("," + controller + ",") == kind.npos) continue;
    for (fs::path group = fs::path(line.substr(path)).relative_path();; group = group.parent_path()) {
      f(mount / group);
      if (group.empty()) break;
    }
  }
}

}  // namespace tandem
