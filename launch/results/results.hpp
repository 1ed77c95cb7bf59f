// What a run leaves behind in its folder: bodies.csv, joints.csv, particles.{h5,xdmf}, bodies.{h5,xdmf} and
// frames/. The summary, the report and the picture are made from these at the end. common/scene/columns.hpp
// names the columns of bodies.csv and joints.csv, which come after "time"; contact loads are window means.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/scene/model.hpp"
#include "launch/results/signals.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Results {
 public:
  // `meshes` are those of the walls with a mesh file, by wall name; other shapes are made here.
  Results(const std::filesystem::path& folder, const scene::Scene& scene,
          const std::vector<protocol::NamedMesh>& meshes);
  ~Results();

  // Rows of an earlier part of the run, before the first record(): those of bodies.csv and joints.csv in its
  // folder up to these marks.
  void begin_with(const std::filesystem::path& earlier, const RowMark& bodies, const RowMark& joints);
  // One row per window end; nullptr where that solver is absent.
  void record(Nanoseconds time, const protocol::BodiesFrame* bodies, const protocol::LoadSet* loads);
  // One frame of the ParaView series, written while the run goes on: this waits for the frame before. A
  // failure to write one is thrown by the call that comes next, of any of these.
  void write_frame(Nanoseconds time, const protocol::BodiesFrame* bodies,
                   const protocol::ParticlesFrame* particles);
  // Waits until the last frame is written.
  void finish();
  // Waits until the rows so far are on the disk itself.
  void flush_rows();

  const Signals& bodies() const;
  const Signals& joints() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tandem::launch
