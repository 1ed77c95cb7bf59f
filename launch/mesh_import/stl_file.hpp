// Whether an STL file is whole.
#pragma once

#include <filesystem>

namespace tandem::launch {

// Error{scene} where a binary STL file is not as long as its number of triangles says, or an ASCII one ends
// before its last `endsolid`: a copy or download that was cut off. Binary: 80 bytes of text, the number of
// triangles n (4 bytes, little-endian), 50 n bytes.
void expect_whole_stl(const std::filesystem::path& file);

}  // namespace tandem::launch
