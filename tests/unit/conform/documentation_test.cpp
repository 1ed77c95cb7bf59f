#include "launch/conform/check.hpp"
#include "tests/support/page_table.hpp"

namespace tandem::test {
namespace {

TEST(ConformPage, HoldsTheTableOfChecks) {
  expect_on_page("docs/conform.md", "checks", conform::checks_as_markdown());
}

}  // namespace
}  // namespace tandem::test
