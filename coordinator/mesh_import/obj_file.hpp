// What is checked of an OBJ file before the importer reads it.
#pragma once

#include <cstddef>
#include <filesystem>

namespace tandem::launch {

// Cutting a face into triangles takes a time that grows with the square of its corners: some 0.1 s for so
// many, and minutes for half a million.
inline constexpr std::size_t most_corners = 4096;

// Throws Error{scene} with the line of a face that has more corners.
void expect_short_faces(const std::filesystem::path& file);

}  // namespace tandem::launch
