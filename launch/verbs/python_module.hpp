// Verbs that are modules of the Python package of tandem.
#pragma once

#include <string>
#include <vector>

namespace tandem::launch {

// Replaces this process by `python3 -m MODULE WORDS...`, with the package next to this program; runs that it
// starts are those of this very program. Throws Error{resource} where Python is missing.
[[noreturn]] void become_python(const std::string& module, const std::vector<std::string>& words);

}  // namespace tandem::launch
