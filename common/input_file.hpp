// Files that users name: only plain files are opened, and no more than a stated size is read. A folder has no
// text, a pipe or a device may have no end or never answer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/error.hpp"

namespace tandem {

struct InputFile {
  ErrorCode code = ErrorCode::scene;  // of a refusal
  std::uint64_t largest = 0;          // [bytes]
  std::string hint = {};              // what to give instead of a file that cannot be read
  const char* secret = nullptr;       // "key": what it is, if only its owner may have access to it
};

// Scenes, URDF models, studies, summaries: what is read as a whole before anything is checked.
inline constexpr std::uint64_t largest_text = std::uint64_t{256} << 20;
inline constexpr std::uint64_t largest_mesh = std::uint64_t{2} << 30;
inline constexpr std::uint64_t largest_particle_file = std::uint64_t{8} << 30;

// The content of the file, once. Throws Error with the file as its place where it is a folder, a pipe, a
// device or a socket, cannot be read, is larger than `input.largest`, or is a secret that others can read
// or that belongs to another user.
std::string read_input(const std::filesystem::path& file, const InputFile& input);

// Throws as read_input() does, and reads nothing: for files that a library opens by their name.
void expect_input(const std::filesystem::path& file, const InputFile& input);

}  // namespace tandem
