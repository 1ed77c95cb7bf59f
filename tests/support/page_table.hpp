// Tables of pages that the code generates, each between two marks. With TANDEM_WRITE_DOCS set, a test writes
// its table.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace tandem::test {

// `page`: the path from the root. Its table is between <!-- begin NAME --> and <!-- end NAME -->.
inline void expect_on_page(const std::string& page, const std::string& name, const std::string& table) {
  const std::string path = TANDEM_SOURCE_DIR "/" + page;
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::string all = text.str();
  const std::string begin = "<!-- begin " + name + " -->\n\n", end = "\n<!-- end " + name + " -->";
  const auto mark = all.find(begin), to = all.find(end);
  ASSERT_TRUE(mark != std::string::npos && to != std::string::npos) << page << " has no place for: " << name;
  const auto from = mark + begin.size();
  if (std::getenv("TANDEM_WRITE_DOCS") != nullptr)
    std::ofstream(path) << all.replace(from, to - from, table);
  else
    EXPECT_EQ(all.substr(from, to - from), table)
        << "run with TANDEM_WRITE_DOCS=1 to bring " << page << " up to date";
}

}  // namespace tandem::test
