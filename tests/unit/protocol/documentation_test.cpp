// docs/protocol.md contains the tables that generate the code.
#include "protocol/documentation.hpp"

#include "tests/support/page_table.hpp"

namespace tandem::protocol::test {
namespace {

TEST(Documentation, HoldsTheTablesOfTheCode) {
  for (const auto& [name, table] : documentation_tables())
    tandem::test::expect_on_page("docs/protocol.md", name, table);
}

}  // namespace
}  // namespace tandem::protocol::test
