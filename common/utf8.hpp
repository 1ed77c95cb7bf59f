// Text that comes from outside: from a command line, a path, another program.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tandem {

// Whether the bytes are UTF-8 as RFC 3629 has it: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text);

// The text as a message may hold it: bytes that are not UTF-8, and control characters but for the line break
// and the tabulator, become "\xff".
std::string printable(std::string_view text);

// The text as a message may repeat it: all of it, or its begin and "..." where it has more than `longest`
// bytes (> 3). Characters stay whole.
std::string shortened(std::string_view text, std::size_t longest = 100);

}  // namespace tandem
