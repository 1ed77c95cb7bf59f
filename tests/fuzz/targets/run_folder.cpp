// The files that `tandem ps` and studies read of other users' runs: the marker and the summary. A run must
// always have a status.
#include "common/error.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/run_folder/run_state.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace run_folder_part {

constexpr const char* files[] = {launch::marker_name, launch::summary_name};

class RunFolderTarget : public Target {
 public:
  explicit RunFolderTarget(const std::filesystem::path& folder) : folder_(folder) {}

  void run(std::span<const std::byte> input) override {
    const unsigned which = chosen(input, std::size(files));
    put(folder_ / files[which], input);
    const launch::RunState state = launch::read_run(folder_);
    std::filesystem::remove(folder_ / files[which]);
    if (state.marker) {
      expect(!state.status.empty(), "a run with a marker has no status");
      launch::to_text(*state.marker);
    }
    if (!state.marker && state.summary.empty()) throw Error(ErrorCode::usage, "is no run");
  }

 private:
  std::filesystem::path folder_;
};

std::vector<Bytes> run_files_of_others(const std::filesystem::path&) {
  launch::Marker ended = launch::own_marker("waterfall");
  ended.pid = 1;
  ended.ended = true;
  launch::Marker stranger;
  stranger.scene = "drum";
  stranger.host = "nodeb";
  stranger.pid = 4711;
  stranger.boot = "0c5cb3a4-6a3c-4b5e-8f0e-6a8f6d1f3f57";
  std::vector<Bytes> corpus;
  for (const launch::Marker& marker : {ended, stranger})
    corpus.push_back(choice(0, bytes_of(launch::to_text(marker))));
  corpus.push_back(
      choice(1, bytes_of(R"({"status": "running", "windows": 12, "time_s": 0.5, "warnings": ["a", "b"]})")));
  corpus.push_back(
      choice(1, bytes_of(R"({"status": "suspect", "verdict": {"objections": [{"rule": "branch"}]}})")));
  return corpus;
}

}  // namespace run_folder_part

TargetKind run_folder_target() {
  using namespace run_folder_part;
  return {.name = "run_folder",
          .text = true,
          .corpus = run_files_of_others,
          .make = make_target<RunFolderTarget>};
}

}  // namespace tandem::fuzz
