// The secret of a run over DDS: ends that have it may take part. It is passed by a file or the environment,
// never on a command line, which every user of the host can read.
#pragma once

#include <string>

#include "protocol/fd.hpp"

namespace tandem::protocol {

// The environment variable that may contain the secret itself.
inline constexpr const char* secret_variable = "TANDEM_SECRET";

// The text of `file`, or where that is empty of the environment variable, without white space at its ends;
// empty where there is neither. Removes the variable, so that child processes do not inherit it. Throws
// Error{usage} where others can read the file, or the secret is shorter than 32 characters.
std::string take_secret(const std::string& file);

// A file without a name that contains the secret, for child processes that inherit it and get the path
// "/proc/self/fd/N". Throws Error{resource} where there is no memory.
Fd secret_to_inherit(const std::string& secret);

// A new secret: 64 random hexadecimal digits. Throws Error{resource} where the system has none.
std::string make_secret();

}  // namespace tandem::protocol
