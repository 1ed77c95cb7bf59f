// Where the program's data files are (report.py, schema.json, scenes/).
#pragma once

#include <filesystem>

namespace tandem::launch {

// ../share/tandem as seen from the folder of this executable: the same in the build tree and after `cmake
// --install`, wherever the installed folder has been moved to.
std::filesystem::path data_folder();

}  // namespace tandem::launch
