// Text from outside: from a command line, a path, another program.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tandem {

// Whether the bytes are UTF-8 by RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

// The text in a form for messages: bytes that are not UTF-8, and control characters other than line break and
// tabulator, become "\xff".
std::string printable(std::string_view text);

// The text in a length for messages: all of it, or its begin and "..." where it has more than `longest` bytes
// (> 3). Characters stay whole.
std::string shortened(std::string_view text, std::size_t longest = 100);

}  // namespace tandem
