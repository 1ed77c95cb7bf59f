// bodies.h5 + bodies.xdmf: the surfaces of all bodies in their world position, frame by frame.
// HDF5: /bodies/NAME holds what never changes: triangles (m x 3), body (m; -1 is the ground), vertices [m] (n
// x 3; the ground's in the world, a body's in its own frame). /frame_000000/NAME holds the vertices in the
// world [m] (n x 3); "time" [s] is an attribute of the frame's group.
#pragma once

#include <filesystem>
#include <vector>

#include "launch/results/body_meshes.hpp"
#include "launch/results/series/hdf5.hpp"
#include "launch/results/series/xdmf.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class BodySeries {
 public:
  BodySeries(const std::filesystem::path& folder, std::vector<BodyMesh> bodies);
  // `frame` may be null where only the ground is drawn.
  void append(Nanoseconds time, const protocol::BodiesFrame* frame);

 private:
  Hdf5File file_;
  XdmfSeries xdmf_;
  std::vector<BodyMesh> bodies_;
  std::vector<XdmfGrid> grids_;  // one per body; `points` of moving bodies change with each frame
  int frames_ = 0;
};

}  // namespace tandem::launch
