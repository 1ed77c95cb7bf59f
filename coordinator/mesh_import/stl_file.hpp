// Checks that an STL file is complete.
#pragma once

#include <filesystem>

namespace tandem::launch {

// Throws Error{scene} where the length of a binary STL file does not agree with its number of triangles, or
// an ASCII file has no final `endsolid`: a truncated copy or download. Binary: 80 bytes of text, the number
// of triangles n (4 bytes, little-endian), 50 n bytes.
void expect_whole_stl(const std::filesystem::path& file);

}  // namespace tandem::launch
