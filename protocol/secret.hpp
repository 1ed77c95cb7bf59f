// The secret of a run over DDS: whoever has it may take part. It comes by a file or the environment, never on
// a command line, which every user of the host can read.
#pragma once

#include <string>

#include "protocol/fd.hpp"

namespace tandem::protocol {

// The environment variable that may hold the secret itself.
inline constexpr const char* secret_variable = "TANDEM_SECRET";

// The text of `file`, or where that is empty of the environment variable, without white space at its ends;
// empty where there is neither. The variable is gone afterwards, so that programs started from here do not
// have it. Error{usage} where others can read the file, or the secret is shorter than 32 characters.
std::string take_secret(const std::string& file);

// A file without a name that holds the secret, for programs that are started from here and inherit it: they
// are told "/proc/self/fd/N". Error{resource} where there is no memory.
Fd secret_to_inherit(const std::string& secret);

// A new one: 64 random hexadecimal digits. Error{resource} where the system has none.
std::string make_secret();

}  // namespace tandem::protocol
