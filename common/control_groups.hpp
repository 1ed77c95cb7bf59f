// The Linux control groups of this process, which limit its share of a host.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace tandem {

// Calls f with the folder of each group in the file system below `root`, from the process's own to the
// topmost. `controller`: "memory" and the like for groups of version 1, "" for those of version 2. A
// container may see its own group as the topmost.
void for_each_control_group(const std::filesystem::path& root, const std::string& controller,
                            const std::function<void(const std::filesystem::path& folder)>& f);

}  // namespace tandem
