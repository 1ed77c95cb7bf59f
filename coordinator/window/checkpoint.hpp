// Restart files of a run. A checkpoint is a folder, RUN/checkpoint/window_000120, with one file of each
// solver and, written last, the file of the coordinator. Each solver writes its own file; only the newest
// checkpoint is kept. Rows of bodies.csv and joints.csv are not copied: the checkpoint stores the length up
// to which those in the run's folder belong to it.
#pragma once

#include <filesystem>

#include "coordinator/results/results.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/window/coupler.hpp"

namespace tandem::launch {

// The option --checkpoint-every [s] as a time of the protocol. Throws Error{usage} where it is not
// representable: below 1 ns, or longer than its integers allow.
Nanoseconds checkpoint_interval(double seconds);

class Checkpoints {
 public:
  // `file` must outlive this object; the run's folder exists. `every` > 0. `from`: the time at which the
  // run begins or continues.
  Checkpoints(const SceneFile& file, const std::filesystem::path& run_folder, Nanoseconds every,
              Nanoseconds from);

  bool due(Nanoseconds now) const { return intervals(now) > written_; }
  // Writes the state between two windows. The results of the run do not depend on these calls.
  void write(const Solvers& solvers, Coupler& coupler, Results& results);

 private:
  void write_files(const std::filesystem::path& folder, const Solvers& solvers, Coupler& coupler,
                   Results& results) const;
  std::int64_t intervals(Nanoseconds now) const { return (now - from_).count / every_.count; }

  const SceneFile& file_;
  std::filesystem::path folder_, last_;
  Nanoseconds every_, from_;
  std::int64_t written_ = 0;  // number of the interval since from_ after which a state was written last
};

// The folder of the checkpoint that `path` refers to: a checkpoint, its run.h5, or a run, whose newest
// checkpoint is taken. Throws Error{usage} where there is none.
std::filesystem::path find_checkpoint(const std::filesystem::path& path);

// Restores a configured run from a checkpoint. Throws Error{scene} where it belongs to another scene:
// everything except end_time, checks, texts, and output without wall_fields and dissipation must be equal.
void resume(const std::filesystem::path& checkpoint, const SceneFile& file, const Solvers& solvers,
            Coupler& coupler, Results& results);

}  // namespace tandem::launch
