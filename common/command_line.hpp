// The words of a command line.
#pragma once

#include <string>
#include <vector>

namespace tandem {

// Splits as a shell does: blanks separate words, quotes and backslashes keep them. Nothing is expanded: $, ~,
// * and ; are plain characters. Throws Error{usage} at `where` for an open quote, for a backslash at the end,
// and for a command that names no program.
std::vector<std::string> split_command(const std::string& command, const std::string& where);

// A command that split_command() splits into these words.
std::string join_command(const std::vector<std::string>& words);

}  // namespace tandem
