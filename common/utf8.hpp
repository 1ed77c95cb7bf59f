// Text from outside: from a command line, a path, another program.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tandem {

// Whether the bytes are UTF-8 by RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

// The text in a form for messages: bytes that are not UTF-8, characters that change the direction of the text
// behind them, and control characters other than line break and tabulator, become "\xff".
std::string printable(std::string_view text);
// The same on one line: line breaks and tabulators as well. For what a user is asked to trust.
std::string printable_line(std::string_view text);

// The text in a length for messages: all of it, or its begin and "..." where it has more than `longest` bytes
// (> 3). Characters stay whole.
std::string shortened(std::string_view text, std::size_t longest = 100);

// A message of somebody else, a library, that may repeat words of the command line: those with more than 200
// bytes are shortened in it, also behind the = of "--option=value".
std::string with_short_words(std::string message, const std::vector<std::string>& words);

}  // namespace tandem
