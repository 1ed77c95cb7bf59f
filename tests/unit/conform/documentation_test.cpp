// docs/conform.md has the table of checks. With TANDEM_WRITE_DOCS set, this test writes it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "launch/conform/check.hpp"

namespace tandem::test {
namespace {

TEST(ConformPage, HoldsTheTableOfChecks) {
  const std::string path = TANDEM_SOURCE_DIR "/docs/conform.md";
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string page = text.str();
  const std::string begin = "<!-- begin checks -->\n", end = "<!-- end checks -->";
  const auto from = page.find(begin), to = page.find(end);
  ASSERT_TRUE(from != std::string::npos && to != std::string::npos);
  const std::string table = "\n" + conform::checks_as_markdown() + "\n";
  const auto first = from + begin.size();
  if (std::getenv("TANDEM_WRITE_DOCS") != nullptr) {
    page.replace(first, to - first, table);
    std::ofstream(path) << page;
  } else {
    EXPECT_EQ(page.substr(first, to - first), table) << "run with TANDEM_WRITE_DOCS=1 to bring it up to date";
  }
}

}  // namespace
}  // namespace tandem::test
