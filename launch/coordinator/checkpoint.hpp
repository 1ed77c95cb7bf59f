// Restart files of a run. A checkpoint is a folder, RUN/checkpoint/window_000120, with a file of each solver
// and, written last, the coordinator's own. The solvers write theirs themselves; the newest checkpoint stays.
// Rows of bodies.csv and joints.csv are not in it: it says up to where those of the run's folder belong to
// it.
#pragma once

#include <filesystem>

#include "launch/coordinator/coupler.hpp"
#include "launch/coordinator/scene_file.hpp"
#include "launch/results/results.hpp"
#include "launch/run_folder/own_files.hpp"

namespace tandem::launch {

// The option --checkpoint-every [s] as a time of the border. Error{usage} where it is none: below 1 ns, or
// longer than the border can count.
Nanoseconds checkpoint_interval(double seconds);

class Checkpoints {
 public:
  // `file` must outlive this; the run's folder is there. `every` > 0. `from`: the time that the run begins or
  // goes on at.
  Checkpoints(const SceneFile& file, const std::filesystem::path& run_folder, Nanoseconds every,
              Nanoseconds from);

  bool due(Nanoseconds now) const { return intervals(now) > written_; }
  // The state between two windows. Nothing of the run depends on when, or whether, this is called.
  void write(const Solvers& solvers, Coupler& coupler, Results& results);

 private:
  void write_files(const std::filesystem::path& folder, const Solvers& solvers, Coupler& coupler,
                   Results& results) const;
  std::int64_t intervals(Nanoseconds now) const { return (now - from_).count / every_.count; }

  const SceneFile& file_;
  std::filesystem::path folder_, last_;
  Nanoseconds every_, from_;
  std::int64_t written_ = 0;  // intervals since from_ that a state was written after
};

// The folder of the checkpoint that `path` means: a checkpoint, its run.h5, or a run, whose newest one it is.
// Error{usage} where there is none.
std::filesystem::path find_checkpoint(const std::filesystem::path& path);

// Makes a run that has been configured go on from a checkpoint. Error{scene} where it is that of another
// scene: all but end_time, output, checks and texts must be the same.
void resume(const std::filesystem::path& checkpoint, const SceneFile& file, const Solvers& solvers,
            Coupler& coupler, Results& results);

}  // namespace tandem::launch
