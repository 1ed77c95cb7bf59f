#include "forked_child.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>

namespace tandem::protocol::test {

ForkedChild::ForkedChild(const std::function<void()>& in_child) {
  std::fflush(nullptr);
  pid_ = ::fork();
  if (pid_ != 0) return;
  ::alarm(60);  // a child that is forgotten does not stay
  try {
    in_child();
    ::_exit(0);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "child: %s\n", e.what());
    ::_exit(1);
  }
}

ForkedChild::~ForkedChild() {
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void ForkedChild::kill() {
  ::kill(pid_, SIGKILL);
}

}  // namespace tandem::protocol::test
