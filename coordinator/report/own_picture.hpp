// Pictures and films under names that users give: an earlier one of tandem is replaced, nothing else.
#pragma once

#include <filesystem>
#include <string>

namespace tandem::launch {

// Text in the files that `tandem preview` and `tandem movie` write.
inline constexpr const char* own_mark = "made by tandem";

// Throws Error{usage} where `file` is there and is not such a file, or is a link.
void expect_own_or_new(const std::filesystem::path& file);

// Puts the mark into a PNG file. Throws Error{resource}.
void mark_picture(const std::filesystem::path& png);

}  // namespace tandem::launch
