// The tables of docs/protocol.md, made from the lists that the code itself is made from. A test holds the
// page to them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tandem::protocol {

// Each with the name under which the page marks its place:
// <!-- begin messages --> ... <!-- end messages -->
std::vector<std::pair<std::string, std::string>> documentation_tables();

}  // namespace tandem::protocol
