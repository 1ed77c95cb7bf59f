#include "common/error.hpp"

namespace tandem {

std::string_view name(ErrorCode code) {
  switch (code) {
    case ErrorCode::internal:
      return "internal";
    case ErrorCode::usage:
      return "usage";
    case ErrorCode::scene:
      return "scene";
    case ErrorCode::protocol:
      return "protocol";
    case ErrorCode::peer_lost:
      return "peer_lost";
    case ErrorCode::timeout:
      return "timeout";
    case ErrorCode::numerics:
      return "numerics";
    case ErrorCode::resource:
      return "resource";
    case ErrorCode::interrupted:
      return "interrupted";
  }
  return "unknown";
}

int exit_status(ErrorCode code) {
  switch (code) {
    case ErrorCode::usage:
    case ErrorCode::scene:
      return 2;
    case ErrorCode::numerics:
      return 3;
    case ErrorCode::protocol:
    case ErrorCode::peer_lost:
    case ErrorCode::timeout:
      return 4;
    case ErrorCode::resource:
      return 5;
    case ErrorCode::interrupted:
      return 130;
    case ErrorCode::internal:
      return 70;
  }
  return 70;
}

Error::Error(ErrorCode code, std::string what, std::string where, std::string hint)
    : code_(code), problem_(std::move(what)), where_(std::move(where)), hint_(std::move(hint)) {
  if (!where_.empty()) text_ = where_ + ": ";
  text_ += problem_;
  if (!hint_.empty()) text_ += " (" + hint_ + ")";
  // The end of what() for its readers.
  for (std::size_t at = text_.find('\0'); at != std::string::npos; at = text_.find('\0', at))
    text_.replace(at, 1, "\\x00");
}

}  // namespace tandem
