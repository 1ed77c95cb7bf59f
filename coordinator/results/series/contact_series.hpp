// contacts.h5 + contacts.xdmf: the contacts of the bodies of output.contacts with spheres, frame by frame.
// HDF5: /frame_000000/{point [m] (n x 3), force of the sphere on the body [N] (n x 3), body (n; -1 is the
// ground), sphere (n; its id)}, attribute "time" [s] of the group. Each group is a link to a separate file:
// frames/contacts_000000.h5.
#pragma once

#include <filesystem>

#include "coordinator/results/series/frame_file.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

class ContactSeries {
 public:
  // `folder` contains the folder for frames.
  explicit ContactSeries(const std::filesystem::path& folder);
  void append(const protocol::ParticlesFrame& frame);
  void finish() { index_.finish(); }

 private:
  std::filesystem::path folder_;
  FrameIndex index_;
};

}  // namespace tandem::launch
