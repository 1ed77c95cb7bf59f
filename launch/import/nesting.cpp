#include "launch/import/nesting.hpp"

#include <algorithm>
#include <cctype>

namespace tandem::launch {
namespace {

constexpr auto none = std::string_view::npos;

// The position of the ">" that ends the tag at `from`; none where a "<" or the end comes first.
std::size_t end_of_tag(std::string_view xml, std::size_t from) {
  char quote = 0;
  for (std::size_t at = from + 1; at < xml.size(); ++at) {
    const char c = xml[at];
    if (c == '<') return none;
    if (quote != 0)
      quote = c == quote ? '\0' : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '>')
      return at;
  }
  return none;
}

bool begins_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_' || (c & 0x80) != 0;
}

}  // namespace

Nesting nesting_of(std::string_view xml) {
  Nesting found;
  std::size_t depth = 0, line = 1, counted = 0;
  const auto line_of = [&](std::size_t at) {
    line += static_cast<std::size_t>(std::count(xml.begin() + static_cast<std::ptrdiff_t>(counted),
                                                xml.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    counted = at;
    return line;
  };
  const auto wrong = [&](std::size_t at, const char* fault) {
    found.line = line_of(at);
    found.fault = fault;
    return found;
  };
  for (std::size_t at = 0; (at = xml.find('<', at)) != none;) {
    const std::string_view rest = xml.substr(at);
    if (rest.starts_with("<!--") || rest.starts_with("<![CDATA[")) {
      const bool comment = rest.starts_with("<!--");
      const std::size_t end = comment ? xml.find("-->", at + 4) : xml.find("]]>", at + 9);
      if (end == none) return wrong(at, comment ? "a comment has no end" : "a CDATA section has no end");
      at = end + 3;
      continue;
    }
    const std::size_t end = end_of_tag(xml, at);
    if (end == none) return wrong(at, "a tag has no end");
    const char first = rest[1];
    if (first == '/') {
      depth -= depth > 0 ? 1 : 0;
    } else if (begins_name(first) && xml[end - 1] != '/') {
      if (++depth > found.deepest) found.deepest = depth, found.line = line_of(at);
    }
    at = end + 1;
  }
  return found;
}

}  // namespace tandem::launch
