#include "common/stack_limit.hpp"

#include <sys/resource.h>

#include <algorithm>
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

void expect_open_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  constexpr rlim_t enough = 1024;
  if (limit.rlim_cur < enough && limit.rlim_cur < limit.rlim_max) {
    limit.rlim_cur = std::min(enough, limit.rlim_max);
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
  }
  if (limit.rlim_cur >= least_open_files) return;
  throw Error(ErrorCode::resource,
              "a program may have " + std::to_string(limit.rlim_cur) + " open files, and " +
                  std::to_string(least_open_files) + " are needed",
              "ulimit -n", "type ulimit -n 1024 before, or raise the limit of the batch system");
}

}  // namespace tandem
