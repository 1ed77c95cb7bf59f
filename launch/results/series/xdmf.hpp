// The XDMF side of a time series: a small XML file that tells ParaView which arrays of the HDF5 file make up
// each time step. It is rewritten whole and atomically at each step, so that at any moment it describes only
// what is there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "launch/results/series/hdf5.hpp"

namespace tandem::launch {

enum class Center { node, cell };

struct XdmfAttribute {
  std::string name{};
  Center center = Center::node;
  DatasetInfo array{};  // one column: scalar; three: vector
};

struct XdmfGrid {
  std::string name{};
  DatasetInfo points{};  // [m] (n x 3)
  DatasetInfo cells{};   // point indices of triangles (m x 3) or of single points (m)
  std::vector<XdmfAttribute> attributes{};
};

class XdmfSeries {
 public:
  // Arrays lie in `hdf5_name` beside `file`.
  XdmfSeries(std::filesystem::path file, std::string hdf5_name);
  // One time step [s] of one or more grids.
  void append(double time, const std::vector<XdmfGrid>& grids);

 private:
  std::filesystem::path file_;
  std::string hdf5_name_;
  std::string steps_;  // XML of the steps so far
};

}  // namespace tandem::launch
