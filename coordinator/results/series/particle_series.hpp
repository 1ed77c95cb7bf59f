// particles.h5 + particles.xdmf: all spheres, frame by frame; liquid.h5 + liquid.xdmf: the particles of the
// liquid. HDF5: /frame_000000/{position [m] (n x 3,
// float64: a stored frame must resolve overlaps), velocity [m/s] (n x 3), spin [rad/s] (n x 3), speed [m/s]
// (n), radius [m] (n), id (n)}, attribute "time" [s] of the group. Each group is a link to a separate file:
// frames/particles_000000.h5, frames/liquid_000000.h5.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "coordinator/results/series/frame_file.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class ParticleSeries {
 public:
  // `folder` contains the folder for frames; `name`: of the series, "particles" or "liquid".
  ParticleSeries(const std::filesystem::path& folder, const std::string& name);
  // More columns of the spheres, one value for each. They are in the file as /NAME, and in ParaView.
  struct Column {
    std::string name;
    std::variant<std::vector<std::uint32_t>, std::vector<float>> values;
  };
  void append(const protocol::ParticlesFrame& frame, const std::vector<Column>& columns = {});
  void finish() { index_.finish(); }

 private:
  std::filesystem::path folder_;
  std::string name_;
  FrameIndex index_;
  DatasetInfo points_;  // 0 .. n - 1, the point list that XDMF needs
};

}  // namespace tandem::launch
