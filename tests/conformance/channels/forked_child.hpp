// A child process made by fork(), for factories whose participant's end can be made after it.
#pragma once

#include <sys/types.h>

#include "channel_factory.hpp"

namespace tandem::protocol::test {

class ForkedChild : public Child {
 public:
  // `in_child` never returns to the tests: the child leaves with _exit.
  explicit ForkedChild(const std::function<void()>& in_child);
  ~ForkedChild() override;
  void kill() override;
  Channel& channel() override { return *channel_; }
  void set_channel(std::unique_ptr<Channel> channel) { channel_ = std::move(channel); }

 private:
  pid_t pid_ = -1;
  std::unique_ptr<Channel> channel_;
};

}  // namespace tandem::protocol::test
