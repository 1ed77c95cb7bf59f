#include "common/utf8.hpp"

#include <gtest/gtest.h>

namespace tandem {
namespace {

TEST(Utf8, IsWhatTheStandardSays) {
  for (const char* good :
       {"", "plain", "Größe", "\xe2\x82\xac", "\xf0\x9f\x98\x80", "\xf4\x8f\xbf\xbf", "\xed\x9f\xbf"})
    EXPECT_TRUE(is_utf8(good)) << good;
  // A lone continuation, a truncated character, overlong forms, a surrogate, above U+10FFFF, an invalid
  // first byte.
  for (const char* bad : {"\x80", "\xe2\x82", "\xc0\xaf", "\xe0\x80\xaf", "\xf0\x80\x80\xaf", "\xed\xa0\x80",
                          "\xf4\x90\x80\x80", "\xff", "caf\xe9"})
    EXPECT_FALSE(is_utf8(bad)) << printable(bad);
}

TEST(Utf8, MessagesHoldNoOtherBytesAndNoControlCharacters) {
  EXPECT_EQ(printable("Größe\n\t"), "Größe\n\t");
  EXPECT_EQ(printable("caf\xe9!"), "caf\\xe9!");
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(printable("\x1b[2J\x7f"), "\\x1b[2J\\x7f");
  EXPECT_EQ(printable("a\xe2\x80\xae"
                      "b"),
            "a\\xe2\\x80\\xaeb")
      << "reverses the text behind it";
  EXPECT_EQ(printable("\xe2\x80\xa6"), "\xe2\x80\xa6") << "an ellipsis stays";
  EXPECT_EQ(printable_line("a\nb\t"), "a\\x0ab\\x09");
  EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_TRUE(is_utf8(printable("\xff\xfe\x80 caf\xe9")));
}

TEST(Utf8, MessagesRepeatTheBeginOfLongTexts) {
  EXPECT_EQ(shortened("a word"), "a word");
  EXPECT_EQ(shortened(std::string(100, 'x')), std::string(100, 'x'));
  EXPECT_EQ(shortened(std::string(101, 'x')), std::string(97, 'x') + "...");
  // The euro sign has three bytes.
  const std::string euros = "\xe2\x82\xac\xe2\x82\xac\xe2\x82\xac\xe2\x82\xac";
  for (const std::size_t longest : {6u, 7u, 8u})
    EXPECT_EQ(shortened(euros, longest), "\xe2\x82\xac...") << longest;
  EXPECT_EQ(shortened(euros, 5), "...");
  EXPECT_TRUE(is_utf8(shortened(std::string(99, 'x') + "\xf0\x9f\x98\x80")));
  // Bytes that are not text.
  EXPECT_LE(shortened(std::string(1000, '\x80')).size(), 100u);
}

TEST(Utf8, MessagesOfOthersRepeatTheBeginOfLongWords) {
  const std::string word(300, 'x'), begin = std::string(197, 'x') + "...";
  EXPECT_EQ(with_short_words("not " + word + ", " + word + " {a,b}", {"run", word}),
            "not " + begin + ", " + begin + " {a,b}");
  EXPECT_EQ(with_short_words("--option: " + word, {"--option=" + word}), "--option: " + begin);
  EXPECT_EQ(with_short_words("short", {"short", std::string(200, 'x')}), "short");
}

}  // namespace
}  // namespace tandem
