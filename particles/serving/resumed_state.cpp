#include "particles/serving/resumed_state.hpp"

#include <fmt/format.h>

namespace tandem::particles {

std::uint64_t ResumedState::number(const char* name) const {
  std::uint64_t value = 0;
  file_.read(name, value);
  return value;
}

void ResumedState::expect_same(const char* what, const std::string& found, const std::string& ours,
                               const char* hint) const {
  if (found != ours)
    throw Error(ErrorCode::scene, fmt::format("is a state of {} {}, the scene has {}", what, found, ours),
                order_.path, hint);
}

void ResumedState::expect_sound(const char* name, bool sound, const char* problem) const {
  if (!sound)
    throw Error(ErrorCode::resource, fmt::format("its array '{}' is damaged: {}", name, problem), order_.path,
                "continue from another checkpoint");
}

void ResumedState::expect_time(Nanoseconds time) const {
  if (time != order_.time)
    throw Error(ErrorCode::resource,
                fmt::format("is the state at {} s, not at {} s", to_seconds(time), to_seconds(order_.time)),
                order_.path, "give the files of one checkpoint");
}

}  // namespace tandem::particles
