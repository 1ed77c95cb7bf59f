// What kind of file is imported.
#pragma once

#include <filesystem>

namespace tandem::launch {

enum class ModelFormat { urdf, step };

// By its content, and where that says nothing by its ending. Throws Error{scene} for other formats, with what
// is read.
ModelFormat format_of(const std::filesystem::path& file);

}  // namespace tandem::launch
