#include "common/scene/no_solver_options.hpp"

#include "common/scene/fault.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

void expect_no_solver_options(const std::vector<std::string>& keys, const std::string& origin,
                              const std::string& part, const std::string& program) {
  if (keys.empty()) return;
  fail(origin, part + ".solver_options." + printable(shortened(keys.front())),
       program + " has no solver options",
       "leave it out, or name the server that knows it: " + part + ".server, or --" + part + "-server");
}

}  // namespace tandem::scene
