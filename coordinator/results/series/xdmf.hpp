// The XDMF side of a time series: a small XML file that describes to ParaView which arrays of the HDF5 file
// form each time step. It is replaced as a whole, so that at any time it refers only to existing arrays.
// Steps in the file are not kept in memory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/results/series/hdf5.hpp"

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
  // Writes nothing yet.
  explicit XdmfSeries(std::filesystem::path file);
  // One time step [s] of one or more grids, for the next write().
  void append(double time, const std::vector<XdmfGrid>& grids);
  // Replaces the file by one with all steps so far.
  void write();

 private:
  std::filesystem::path file_;
  std::string steps_;              // XML of the steps that are not in the file yet
  std::uint64_t without_end_ = 0;  // bytes of the file before its closing tags; 0: there is no file
};

}  // namespace tandem::launch
