// particles.h5 + particles.xdmf: all particles, frame by frame.
// HDF5: /frame_000000/{position [m] (n x 3, float64: a stored frame must resolve overlaps), velocity [m/s] (n
// x 3), spin [rad/s] (n x 3), speed [m/s] (n), radius [m] (n), id (n)}, attribute "time" [s] of the group.
#pragma once

#include <filesystem>

#include "launch/results/series/hdf5.hpp"
#include "launch/results/series/xdmf.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class ParticleSeries {
 public:
  explicit ParticleSeries(const std::filesystem::path& folder);
  void append(const protocol::ParticlesFrame& frame);

 private:
  Hdf5File file_;
  XdmfSeries xdmf_;
  DatasetInfo points_;  // 0 .. n - 1, as XDMF wants to have the points named
  int frames_ = 0;
};

// "/frame_000012", so that names sort as the frames do.
std::string frame_group(int frame);

}  // namespace tandem::launch
