// The files that a run writes to its folder: bodies.csv, joints.csv, elements.csv, sensors.csv,
// particles.{h5,xdmf}, liquid.{h5,xdmf}, bodies.{h5,xdmf} and frames/. Summary, report and picture are made
// from these at the end. common/scene/columns.hpp names the columns of the CSV files, which follow "time";
// contact loads are window means.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "common/scene/model.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "coordinator/results/signals.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class Results {
 public:
  // `meshes` are those of the walls with a mesh, by wall name; other walls are generated here. `shapes` are
  // those that are only drawn.
  Results(const std::filesystem::path& folder, const scene::Scene& scene,
          const std::vector<protocol::NamedMesh>& meshes, const std::vector<BodyMesh>& shapes = {});
  ~Results();

  // Creates elements.csv, where the scene has elements. Call before anything else where the frames of the
  // bodies have the elements.
  void add_elements();
  // The files of rows: bodies.csv, joints.csv and, where they were created, elements.csv and sensors.csv.
  std::vector<const Signals*> signals() const;
  // Copies the rows of an earlier part of the run, before the first record(): those of signals() in `earlier`
  // up to these marks.
  void begin_with(const std::filesystem::path& earlier, const std::vector<RowMark>& marks);
  // One row per window end; nullptr where that solver is absent.
  void record(Nanoseconds time, const protocol::BodiesFrame* bodies, const protocol::LoadSet* loads);
  // Group and material of each sphere by its id, for frames whose scene asks for them. Call before the first
  // frame.
  void set_groups(std::vector<std::uint32_t> group_of_sphere);
  // Memory for the particles of the next frame, which are then not copied. Waits for the previous frame.
  protocol::ParticlesFrame& particles_to_write();
  protocol::ParticlesFrame& liquid_to_write();
  // Writes one frame of the ParaView series concurrently with the run; waits for the previous frame.
  // `prepare` gets the particles first, in the order of the frames: it may decode them, and checks them. If
  // one of the two fails, the next call of any of these functions throws. The liquid is that of
  // liquid_to_write().
  using PrepareParticles = std::function<void(protocol::ParticlesFrame&)>;
  void write_frame(Nanoseconds time, const protocol::BodiesFrame* bodies,
                   const protocol::ParticlesFrame* particles, PrepareParticles prepare = {});
  // Waits until the last frame is written.
  void finish();
  // Waits until all rows so far are stored on the disk.
  void flush_rows();

  const Signals& bodies() const;
  const Signals& joints() const;
  const Signals* elements() const;  // null where elements.csv was not created
  const Signals* sensors() const;   // null where the scene has no sensors of particles

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tandem::launch
