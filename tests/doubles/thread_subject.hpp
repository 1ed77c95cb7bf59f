// A participant under the judge that runs in a thread of the test.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <thread>

#include "launch/conform/subject.hpp"
#include "protocol/inproc/inproc_channel.hpp"
#include "protocol/participant/serve.hpp"

namespace tandem::test {

class ThreadInstance final : public conform::Instance {
 public:
  // `participant` serves the channel and returns its exit status.
  ThreadInstance(protocol::Role role,
                 const std::function<int(std::unique_ptr<protocol::Channel>)>& participant) {
    auto [own, theirs] = protocol::create_inproc(protocol::name(role));
    channel_ = std::move(own);
    std::packaged_task<int()> task(
        [participant, end = std::move(theirs)]() mutable { return participant(std::move(end)); });
    status_ = task.get_future().share();
    thread_ = std::thread(std::move(task));
  }
  ~ThreadInstance() override {
    channel_.reset();
    thread_.join();
  }
  std::unique_ptr<protocol::Channel> take_channel() override { return std::move(channel_); }
  std::optional<std::string> ending(std::chrono::milliseconds patience) override {
    if (status_.wait_for(patience) != std::future_status::ready) return {};
    return "exited with status " + std::to_string(status_.get());
  }

 private:
  std::unique_ptr<protocol::Channel> channel_;
  std::shared_future<int> status_;
  std::thread thread_;
};

class ThreadSubject final : public conform::Subject {
 public:
  using Participant = std::function<int(std::unique_ptr<protocol::Channel>)>;
  ThreadSubject(protocol::Role role, Participant participant)
      : role_(role), participant_(std::move(participant)) {}
  // A solver that is made anew for each start.
  template <class AnySolver>
  ThreadSubject(protocol::Role role, std::function<std::unique_ptr<AnySolver>()> make)
      : ThreadSubject(role, [make](std::unique_ptr<protocol::Channel> channel) {
          const auto solver = make();
          return protocol::serve(*channel, *solver, "double 1.0");
        }) {}

  protocol::Role role() const override { return role_; }
  std::unique_ptr<conform::Instance> start(const std::filesystem::path&) override {
    return std::make_unique<ThreadInstance>(role_, participant_);
  }

 private:
  protocol::Role role_;
  Participant participant_;
};

}  // namespace tandem::test
