// A new file that only its owner can read.
#pragma once

#include <filesystem>
#include <string>

namespace tandem::launch {

void write_private_file(const std::filesystem::path& path, const std::string& text);

}  // namespace tandem::launch
