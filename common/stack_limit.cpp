#include "common/stack_limit.hpp"

#include <sys/resource.h>

#include <string>

#include "common/error.hpp"

namespace tandem {

void expect_stack() {
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= least_stack) return;
  throw Error(ErrorCode::resource,
              "the stack is limited to " + std::to_string(limit.rlim_cur >> 10) + " KiB, and " +
                  std::to_string(least_stack >> 10) + " are needed",
              "ulimit -s", "type ulimit -s 8192 before, or raise the limit of the batch system");
}

}  // namespace tandem
