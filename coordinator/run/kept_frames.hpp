// The frames between the programs of a run, for `tandem replay`: all of them in the file of --record, or else
// the last ones in memory, which a failed run leaves in its folder.
#pragma once

#include <filesystem>
#include <memory>

#include "common/error.hpp"
#include "protocol/last_frames.hpp"

namespace tandem::launch {

class KeptFrames {
 public:
  // `record` is the file of --record, or empty.
  KeptFrames(const std::filesystem::path& record, const std::filesystem::path& folder);

  protocol::FrameSink* sink() const { return sink_.get(); }
  // Writes the last frames, unless the user interrupted the run. Returns `error`, by which the run ends, with
  // the name of the file added to its hint.
  Error keep(const Error& error) const;

 private:
  std::filesystem::path file_;
  std::shared_ptr<protocol::LastFrames> last_;  // null with --record
  std::shared_ptr<protocol::FrameSink> sink_;
};

}  // namespace tandem::launch
