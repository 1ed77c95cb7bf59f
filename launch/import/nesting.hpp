// Nesting depth of the elements of an XML text, checked before a recursive parser reads it.
#pragma once

#include <cstddef>
#include <string_view>

namespace tandem::launch {

struct Nesting {
  std::size_t deepest = 0;      // levels of elements
  std::size_t line = 1;         // of the deepest element, or of the fault
  const char* fault = nullptr;  // what is wrong; null: no fault of the kinds that this scan detects
};

// Handles comments, CDATA, quoted attributes and empty elements. A "<" inside a tag or a declaration is a
// fault, as in any XML, so that the scan and a parser find the same tags.
Nesting nesting_of(std::string_view xml);

}  // namespace tandem::launch
