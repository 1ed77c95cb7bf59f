// The tables of docs/protocol.md, generated from the lists that also generate the code. A test compares the
// page with them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tandem::protocol {

// Each table with the name that marks its place in the page: <!-- begin messages --> ... <!-- end messages
// -->
std::vector<std::pair<std::string, std::string>> documentation_tables();

}  // namespace tandem::protocol
