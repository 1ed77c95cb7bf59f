// The folder that a run leaves behind.
#pragma once

#include <filesystem>

namespace tandem::launch {

// Makes `folder` ready: created when missing; an earlier run's files in it are removed, so that no result of
// that run can be taken for one of this. A folder that holds something else, or whose run still goes on on this
// host, is refused. Error{usage} or Error{resource}. Returns whether the earlier run died.
bool prepare_run_folder(const std::filesystem::path& folder);

}  // namespace tandem::launch
