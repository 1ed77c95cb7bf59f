#include "protocol/inproc/inproc_channel.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>

#include "common/error.hpp"
#include "protocol/latch.hpp"

namespace tandem::protocol {
namespace {

// Frames in transit in one direction. A stored buffer is swapped with the reader's, so that nothing is copied
// twice and, once the buffers have grown, nothing is allocated.
class Pipe {
 public:
  explicit Pipe(WaitPolicy policy) : writer_spinner_(policy), reader_spinner_(policy) {}

  bool push(std::span<const std::span<const std::byte>> parts, Deadline deadline) {
    if (!wait_until([this] { return used_ < slots_.size() || closed_; }, writer_spinner_, deadline))
      return false;
    std::lock_guard lock(mutex_);
    Bytes& slot = slots_[(first_ + used_) % slots_.size()];
    slot.clear();
    for (const auto& part : parts) slot.insert(slot.end(), part.begin(), part.end());
    ++used_;
    changed_.notify_all();
    return true;
  }

  // Returns false at the deadline, true when there is a frame or the other end is closed.
  bool wait(Deadline deadline) {
    return wait_until([this] { return used_ > 0 || closed_; }, reader_spinner_, deadline);
  }

  // Returns false where there is no frame.
  bool pop(std::vector<std::byte>& frame) {
    std::lock_guard lock(mutex_);
    if (used_ == 0) return false;
    frame.swap(slots_[first_]);
    first_ = (first_ + 1) % slots_.size();
    --used_;
    changed_.notify_all();
    return true;
  }

  void close() {
    std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  bool closed() const { return closed_; }
  bool empty() const { return used_ == 0; }

 private:
  using Bytes = std::vector<std::byte>;

  template <class Ready>
  bool wait_until(const Ready& ready, Spinner& spinner, Deadline deadline) {
    if (ready()) return true;
    const Clock::time_point begin = Clock::now();
    bool done = spinner.spin(ready, begin, deadline);
    if (!done && spinner.may_sleep()) {
      std::unique_lock lock(mutex_);
      done = changed_.wait_until(lock, deadline, ready);
    }
    spinner.learn(Clock::now() - begin);
    return done;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<Bytes, 8> slots_;
  std::size_t first_ = 0;
  // written under the mutex; read without it by a spinning end
  std::atomic<std::size_t> used_ = 0;
  std::atomic<bool> closed_ = false;
  Spinner writer_spinner_, reader_spinner_;
};

struct Pair {
  explicit Pair(WaitPolicy policy) : to_participant(policy), to_coordinator(policy) {}
  Pipe to_participant, to_coordinator;
};

class InprocChannel : public Channel {
 public:
  InprocChannel(std::shared_ptr<Pair> pair, Pipe& out, Pipe& in, std::string peer)
      : pair_(std::move(pair)), out_(out), in_(in), peer_(std::move(peer)) {}
  ~InprocChannel() override {
    out_.close();
    in_.close();
  }

  void send(std::span<const std::span<const std::byte>> parts, Deadline deadline) override {
    latch_([&] {
      if (out_.closed()) throw lost();
      if (!out_.push(parts, deadline)) throw Error(ErrorCode::timeout, peer_ + " took no message");
    });
  }

  bool wait(Deadline deadline) override {
    return latch_([&] {
      if (!in_.wait(deadline)) return false;
      if (in_.empty()) throw lost();
      return true;
    });
  }

  void receive(std::vector<std::byte>& frame, Deadline deadline) override {
    latch_([&] {
      if (!in_.wait(deadline)) throw Error(ErrorCode::timeout, peer_ + " sent no message");
      if (!in_.pop(frame)) throw lost();
    });
  }

  bool peer_gone() noexcept override { return in_.closed(); }
  const char* transport() const override { return "inproc"; }
  const std::string& peer() const override { return peer_; }

 private:
  Error lost() const { return Error(ErrorCode::peer_lost, peer_ + " closed its end"); }

  std::shared_ptr<Pair> pair_;
  Pipe& out_;
  Pipe& in_;
  std::string peer_;
  FailureLatch latch_;
};

}  // namespace

std::pair<std::unique_ptr<Channel>, std::unique_ptr<Channel>> create_inproc(const std::string& participant,
                                                                            WaitPolicy wait) {
  const auto pair = std::make_shared<Pair>(wait);
  return {std::make_unique<InprocChannel>(pair, pair->to_participant, pair->to_coordinator, participant),
          std::make_unique<InprocChannel>(pair, pair->to_coordinator, pair->to_participant, "coordinator")};
}

}  // namespace tandem::protocol
