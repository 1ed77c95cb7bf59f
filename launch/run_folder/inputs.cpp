#include "launch/run_folder/inputs.hpp"

#include <system_error>

#include "common/error.hpp"
#include "launch/run_folder/own_files.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// Whether a run in `folder`, a path without links, writes a file of this name.
bool would_go(const fs::path& file, const fs::path& folder) {
  std::error_code failure;
  const fs::path absolute = fs::absolute(file);
  const fs::path named = fs::weakly_canonical(absolute.parent_path(), failure) / absolute.filename();
  for (const fs::path& name : {named, fs::weakly_canonical(absolute, failure)}) {
    const fs::path inside = name.lexically_relative(folder);
    if (!inside.empty() && *inside.begin() != ".." && is_own_file(inside)) return true;
  }
  return false;
}

void expect_file_kept(const fs::path& file, const fs::path& folder, const fs::path& shown) {
  if (would_go(file, folder))
    throw Error(
        ErrorCode::usage,
        "is an input of this run, and is in the folder of its results under a name that the run writes: "
        "the run would delete it",
        file.string(), "give another --out than " + shown.string() + ", or move the file");
}

}  // namespace

void expect_kept(const std::vector<fs::path>& inputs, const fs::path& folder) {
  std::error_code failure;
  const fs::path target = fs::weakly_canonical(fs::absolute(folder), failure);
  for (const fs::path& input : inputs) {
    if (!fs::is_directory(input, failure)) {
      expect_file_kept(input, target, folder);
      continue;
    }
    for (fs::recursive_directory_iterator at(input, failure), end; !failure && at != end;
         at.increment(failure))
      if (std::error_code unknown; !at->is_directory(unknown)) expect_file_kept(at->path(), target, folder);
  }
}

void expect_free_name(const fs::path& output, const fs::path& folder, const char* option) {
  std::error_code failure;
  if (would_go(output, fs::weakly_canonical(fs::absolute(folder), failure)))
    throw Error(ErrorCode::usage, "is the name of a result of this run", option + (" " + output.string()),
                "give another name, or a file outside " + folder.string());
}

}  // namespace tandem::launch
