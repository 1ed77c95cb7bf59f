#include "common/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace tandem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> split(const std::string& command) {
  return split_command(command, "--dem-server");
}

TEST(CommandLine, IsSplitAsAShellDoes) {
  EXPECT_THAT(split("solver"), ElementsAre("solver"));
  EXPECT_THAT(split("  solver\t--in  a.in \n"), ElementsAre("solver", "--in", "a.in"));
  EXPECT_THAT(split("'my solver' \"a b\""), ElementsAre("my solver", "a b"));
  EXPECT_THAT(split(R"(my\ solver a\"b \\)"), ElementsAre("my solver", "a\"b", "\\"));
  EXPECT_THAT(split(R"(s --name='a "b"'c"d 'e'")"), ElementsAre("s", R"(--name=a "b"cd 'e')"));
  EXPECT_THAT(split("s '' \"\""), ElementsAre("s", "", ""));
  EXPECT_THAT(split(R"(s 'a\b' "a\b" "a\"b" "a\\b")"),
              ElementsAre("s", R"(a\b)", R"(a\b)", "a\"b", R"(a\b)"));
}

TEST(CommandLine, NothingIsExpanded) {
  EXPECT_THAT(split("s $HOME ~ *.in `id` a;b >c | d & #e"),
              ElementsAre("s", "$HOME", "~", "*.in", "`id`", "a;b", ">c", "|", "d", "&", "#e"));
}

TEST(CommandLine, WhatIsNoCommandIsRefused) {
  const auto refusal = [](const std::string& command) -> std::string {
    try {
      split(command);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_EQ(error.where(), "--dem-server");
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("s 'a b"), HasSubstr("the quote ' in character 3 of 's 'a b' is not closed"));
  EXPECT_THAT(refusal("s \"a\\\""), HasSubstr("the quote \" in character 3"));
  EXPECT_THAT(refusal("s a\\"), HasSubstr("ends with a backslash"));
  for (const char* nothing : {"", " \t", "''", "'' a"})
    EXPECT_THAT(refusal(nothing), HasSubstr("the command names no program")) << nothing;
}

TEST(CommandLine, WhatIsJoinedIsSplitIntoTheSameWords) {
  const std::vector<std::string> words{"/a b/s", "", "it's", "\"", "\\", "$x", "plain-1.0", "\n"};
  EXPECT_EQ(split(join_command(words)), words);
  EXPECT_EQ(join_command({"/bin/s", "--a=b"}), "/bin/s --a=b");
}

}  // namespace
}  // namespace tandem
