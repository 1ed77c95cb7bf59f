// bodies.h5 + bodies.xdmf: the surfaces of all bodies in their world position, frame by frame. HDF5:
// /bodies/NAME has the constant data: triangles (m x 3), body (m; -1 is the ground), vertices [m] (n x 3; the
// ground's in the world, a body's in its own frame). /frame_000000/NAME has the vertices in the world [m] (n
// x 3), and /frame_000000/NAME.pressure etc. the columns of its triangles; "time" [s] is an attribute of the
// frame's group. Each of these groups is a link to a separate file:
// frames/surfaces.h5, frames/bodies_000000.h5.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "coordinator/results/body_meshes.hpp"
#include "coordinator/results/series/frame_file.hpp"
#include "coordinator/results/wall_fields.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class BodySeries {
 public:
  // `folder` contains the folder for frames.
  BodySeries(const std::filesystem::path& folder, std::vector<BodyMesh> bodies);
  // `frame` may be null where only the ground is drawn. `columns`: cell data of each body, in their order, or
  // empty.
  void append(Nanoseconds time, const protocol::BodiesFrame* frame,
              const std::vector<std::vector<CellColumn>>& columns = {});
  void finish() { index_->finish(); }

 private:
  std::filesystem::path folder_;
  std::vector<BodyMesh> bodies_;
  std::vector<XdmfGrid> grids_;      // one per body; `points` of moving bodies change with each frame
  std::optional<FrameIndex> index_;  // once the file of the surfaces is there
};

}  // namespace tandem::launch
