// The files that a run reads must not be among those that it deletes or writes over.
#pragma once

#include <filesystem>
#include <vector>

namespace tandem::launch {

// Throws Error{usage} where one of `inputs`, a file or a folder with files, is in the results folder `folder`
// under a name that a run writes: the run would delete it. Symbolic links count as what they are, and as what
// they lead to.
void expect_kept(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& folder);

// The same for a file that the run writes besides its results.
void expect_free_name(const std::filesystem::path& output, const std::filesystem::path& folder,
                      const char* option);

}  // namespace tandem::launch
