#include "common/command_line.hpp"

#include <algorithm>
#include <string_view>

#include "common/error.hpp"
#include "common/utf8.hpp"

namespace tandem {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// Characters that need no quotes in any shell.
bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-+=./:,@%").find(c) != std::string_view::npos;
}

}  // namespace

std::vector<std::string> split_command(const std::string& command, const std::string& where) {
  std::vector<std::string> words;
  std::string word;
  bool open = false;  // inside a word, which may be empty: ''
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (is_blank(c)) {
      if (open) words.push_back(word);
      word.clear();
      open = false;
      continue;
    }
    open = true;
    if (c == '\'' || c == '"') {
      const std::size_t begin = i;
      for (++i; i < command.size() && command[i] != c; ++i) {
        // Between double quotes a backslash protects a quote and a backslash only.
        if (c == '"' && command[i] == '\\' && i + 1 < command.size() &&
            (command[i + 1] == '"' || command[i + 1] == '\\'))
          ++i;
        word += command[i];
      }
      if (i == command.size())
        throw Error(ErrorCode::usage,
                    std::string("the quote ") + c + " in character " + std::to_string(begin + 1) + " of '" +
                        printable(shortened(command)) + "' is not closed",
                    where, std::string("add a ") + c + " at the end, or write \\" + c);
    } else if (c == '\\') {
      if (i + 1 == command.size())
        throw Error(ErrorCode::usage, "'" + printable(shortened(command)) + "' ends with a backslash", where,
                    "write \\\\ for a backslash");
      word += command[++i];
    } else {
      word += c;
    }
  }
  if (open) words.push_back(word);
  if (words.empty() || words.front().empty())
    throw Error(ErrorCode::usage, "the command names no program", where, "give a program and its arguments");
  return words;
}

std::string join_command(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) {
    if (!command.empty()) command += ' ';
    if (!word.empty() && std::ranges::all_of(word, is_plain)) {
      command += word;
      continue;
    }
    command += '\'';
    for (const char c : word) command += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += '\'';
  }
  return command;
}

}  // namespace tandem
