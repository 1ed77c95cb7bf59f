// Times in seconds from a command line.
#pragma once

#include <chrono>
#include <string>

namespace tandem {

// Converts `seconds` to milliseconds. Throws Error{usage} where it is not a number between `least` and
// `most`, with the valid range; `option` is its name: "--lease".
std::chrono::milliseconds bounded_seconds(double seconds, std::chrono::milliseconds least,
                                          std::chrono::milliseconds most, const std::string& option);

// Limits of the options of `tandem run` and of the servers.
inline constexpr std::chrono::milliseconds least_lease{50}, most_lease{3'600'000};
inline constexpr std::chrono::milliseconds least_patience{100}, most_patience{1'000'000'000};

}  // namespace tandem
