// docs/protocol.md contains the tables that generate the code. With TANDEM_WRITE_DOCS set, this test writes
// them.
#include "protocol/documentation.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace tandem::protocol::test {
namespace {

std::string read(const std::string& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(Documentation, HoldsTheTablesOfTheCode) {
  const std::string path = TANDEM_SOURCE_DIR "/docs/protocol.md";
  std::string page = read(path);
  const bool write = std::getenv("TANDEM_WRITE_DOCS") != nullptr;
  for (const auto& [name, table] : documentation_tables()) {
    const std::string begin = "<!-- begin " + name + " -->\n", end = "<!-- end " + name + " -->";
    const auto from = page.find(begin);
    const auto to = page.find(end);
    ASSERT_TRUE(from != std::string::npos && to != std::string::npos)
        << path << " has no place for: " << name;
    const auto first = from + begin.size();
    if (write)
      page.replace(first, to - first, "\n" + table + "\n");
    else
      EXPECT_EQ(page.substr(first, to - first), "\n" + table + "\n")
          << "run with TANDEM_WRITE_DOCS=1 to bring " << path << " up to date";
  }
  if (write) std::ofstream(path) << page;
}

}  // namespace
}  // namespace tandem::protocol::test
