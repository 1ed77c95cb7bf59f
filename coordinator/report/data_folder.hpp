// The folder of the program's data files (report.py, schema.json, scenes/, python/).
#pragma once

#include <filesystem>

namespace tandem::launch {

// ../share/tandem relative to the folder of this executable: the same in the build tree and after `cmake
// --install`, wherever the installed folder is moved.
std::filesystem::path data_folder();

}  // namespace tandem::launch
