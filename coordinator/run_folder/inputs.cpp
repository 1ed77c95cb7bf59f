#include "coordinator/run_folder/inputs.hpp"

#include <set>
#include <system_error>

#include "common/error.hpp"
#include "coordinator/run_folder/own_files.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// Of paths without links.
bool is_inside(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Whether a run in `folder`, a path without links, writes a file of this name.
bool would_go(const fs::path& file, const fs::path& folder) {
  std::error_code failure;
  const fs::path absolute = fs::absolute(file);
  const fs::path named = fs::weakly_canonical(absolute.parent_path(), failure) / absolute.filename();
  for (const fs::path& name : {named, fs::weakly_canonical(absolute, failure)}) {
    if (is_inside(name, folder) && is_own_file(name.lexically_relative(folder))) return true;
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

// A folder elsewhere, with perhaps very many frames, can only have links into the one of the results. A
// folder that such a link leads to is looked at as well.
void expect_folder_kept(const fs::path& folder, const fs::path& target, const fs::path& shown,
                        std::set<fs::path>& visited) {
  std::error_code failure;
  const fs::path given = fs::weakly_canonical(fs::absolute(folder), failure);
  if (!visited.insert(given).second) return;
  const bool apart = !is_inside(given, target) && !is_inside(target, given);
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code unknown;
    const bool link = at->is_symlink(unknown);
    if (!at->is_directory(unknown)) {
      if (!apart || link) expect_file_kept(at->path(), target, shown);
    } else if (!link || is_inside(fs::weakly_canonical(fs::absolute(at->path()), unknown), target)) {
      expect_folder_kept(at->path(), target, shown, visited);
    }
  }
}

}  // namespace

void expect_kept(const std::vector<fs::path>& inputs, const fs::path& folder) {
  std::error_code failure;
  const fs::path target = fs::weakly_canonical(fs::absolute(folder), failure);
  for (const fs::path& input : inputs) {
    std::set<fs::path> visited;
    if (fs::is_directory(input, failure))
      expect_folder_kept(input, target, folder, visited);
    else
      expect_file_kept(input, target, folder);
  }
}

void expect_free_name(const fs::path& output, const fs::path& folder, const char* option) {
  std::error_code failure;
  if (would_go(output, fs::weakly_canonical(fs::absolute(folder), failure)))
    throw Error(ErrorCode::usage, "is the name of a result of this run", option + (" " + output.string()),
                "give another name, or a file outside " + folder.string());
}

}  // namespace tandem::launch
