// `tandem study`.
//
// The folder holds scenes/KEY.json and runs/KEY/ of each run, results.csv, reading.txt and study.png. A
// second call does only the runs that are missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tandem::launch {

struct StudyOptions {
  std::filesystem::path file, folder;
  int jobs = 0;                   // runs side by side; 0: as many as the cores carry
  std::vector<std::string> want;  // "position=1e-3": errors that the cheapest setting must meet
};

// Exit status: 0; 1 where no setting meets what is wanted.
int study(const StudyOptions& options);

}  // namespace tandem::launch
