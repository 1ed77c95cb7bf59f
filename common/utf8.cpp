#include "common/utf8.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace tandem {
namespace {

// Length of the character at the begin of `text`, 0 where there is none.
std::size_t length_of_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const auto first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xc2 && first < 0xe0   ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const auto second = byte(1);
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool surrogate = first == 0xed && second >= 0xa0;
  const bool too_large = first == 0xf4 && second >= 0x90;
  return overlong || surrogate || too_large ? 0 : length;
}

// Marks, embeddings and isolates of the bidirectional algorithm (Unicode Standard Annex 9): U+200E, U+200F,
// U+202A to U+202E, U+2066 to U+2069. With them a text looks like another one.
bool changes_direction(std::string_view character) {
  if (character.size() != 3 || character[0] != '\xe2') return false;
  const auto second = static_cast<std::uint8_t>(character[1]),
             third = static_cast<std::uint8_t>(character[2]);
  if (second == 0x80) return third == 0x8e || third == 0x8f || (third >= 0xaa && third <= 0xae);
  return second == 0x81 && third >= 0xa6 && third <= 0xa9;
}

template <class IsKept>
std::string escaped(std::string_view text, IsKept is_kept) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = length_of_character(text);
    const std::string_view character = text.substr(0, length == 0 ? 1 : length);
    const auto first = static_cast<unsigned char>(text[0]);
    const bool control = (first < 0x20 || first == 0x7f) && !is_kept(text[0]);
    if (length == 0 || control || changes_direction(character))
      for (const char byte : character) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    else
      out += character;
    text.remove_prefix(character.size());
  }
  return out;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = length_of_character(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string printable(std::string_view text) {
  return escaped(text, [](char c) { return c == '\n' || c == '\t'; });
}

std::string printable_line(std::string_view text) {
  return escaped(text, [](char) { return false; });
}

std::string shortened(std::string_view text, std::size_t longest) {
  constexpr std::string_view rest = "...";
  if (text.size() <= longest) return std::string(text);
  std::size_t end = longest - rest.size();
  // Returns to the begin of a character; a character has at most three bytes after its first.
  for (int i = 0; i < 3 && end > 0 && (static_cast<std::uint8_t>(text[end]) & 0xc0) == 0x80; ++i) --end;
  return std::string(text.substr(0, end)) + std::string(rest);
}

std::string with_short_words(std::string message, const std::vector<std::string>& words) {
  constexpr std::size_t longest = 200;
  const auto shorten = [&message](const std::string& word) {
    const std::string begin = shortened(word, longest);
    if (word.size() <= longest) return;
    for (std::size_t at = 0; (at = message.find(word, at)) != std::string::npos; at += begin.size())
      message.replace(at, word.size(), begin);
  };
  for (const std::string& word : words) {
    shorten(word);
    if (const std::size_t equals = word.find('='); equals != std::string::npos)
      shorten(word.substr(equals + 1));
  }
  return message;
}

}  // namespace tandem
