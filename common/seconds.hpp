// Times that a user gives on a command line, in seconds.
#pragma once

#include <chrono>
#include <string>

namespace tandem {

// `seconds` to the millisecond. Error{usage} where it is no number between `least` and `most`, which says
// what to write instead; `option` is its name: "--lease".
std::chrono::milliseconds bounded_seconds(double seconds, std::chrono::milliseconds least,
                                          std::chrono::milliseconds most, const std::string& option);

// Bounds of what `tandem run` and the servers take.
inline constexpr std::chrono::milliseconds least_lease{50}, most_lease{3'600'000};
inline constexpr std::chrono::milliseconds least_patience{100}, most_patience{1'000'000'000};

}  // namespace tandem
