#include "coordinator/run/kept_frames.hpp"

#include <fmt/format.h>

#include "common/log.hpp"
#include "coordinator/run_folder/own_files.hpp"

namespace tandem::launch {

KeptFrames::KeptFrames(const std::filesystem::path& record, const std::filesystem::path& folder)
    : file_(record.empty() ? folder / last_windows_name : record) {
  if (record.empty())
    sink_ = last_ = std::make_shared<protocol::LastFrames>();
  else
    sink_ = std::make_shared<protocol::Recorder>(record);
}

Error KeptFrames::keep(const Error& error) const {
  // A scene or command line that is wrong is refused with the same sentence again; there is nothing to
  // replay.
  const bool refused = error.code() == ErrorCode::scene || error.code() == ErrorCode::usage;
  if (refused || error.code() == ErrorCode::interrupted) return error;
  if (last_) {
    if (last_->empty()) return error;
    try {
      last_->write(file_);
    } catch (const Error& of_file) {
      log::warn("the last windows are not kept: {}", of_file.what());
      return error;
    }
  }
  return Error(error.code(), error.problem(), error.where(),
               fmt::format("{}{}for tandem replay: {}", error.hint(), error.hint().empty() ? "" : "; ",
                           file_.string()));
}

}  // namespace tandem::launch
