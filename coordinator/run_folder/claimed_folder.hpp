// The folder of the results of a verb that replaces its own files there, such as `tandem study`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tandem::launch {

struct Claim {
  std::string verb;                           // "study"
  std::vector<std::string> names;             // of the files and folders that it writes
  std::vector<std::filesystem::path> inputs;  // that it reads
};

// Creates `folder` where it is missing, and marks it with "tandem_VERB.json". Other files in it stay. Throws
// Error{usage} where it has a file or folder of one of the names but no mark of this user, so that somebody
// else has put it there, where its file of the mark's name is none, where an input has one of the names, and
// where the folder cannot be created.
void claim_folder(const std::filesystem::path& folder, const Claim& claim);

}  // namespace tandem::launch
