// How deep the elements of an XML text are nested, before a parser that calls itself for each level sees it.
#pragma once

#include <cstddef>
#include <string_view>

namespace tandem::launch {

struct Nesting {
  std::size_t deepest = 0;      // levels of elements
  std::size_t line = 1;         // where the deepest begins, or where the text is wrong
  const char* fault = nullptr;  // what is wrong; null: nothing that this scan looks at
};

// Knows comments, CDATA, quoted attributes and empty elements. A "<" inside of a tag or of a declaration is a
// fault, as in any XML: the scan and a parser see the same tags.
Nesting nesting_of(std::string_view xml);

}  // namespace tandem::launch
