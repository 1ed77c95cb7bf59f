// Events from Cyclone's threads for the thread that uses the channel. The listeners only set flags here and
// wake that thread.
#pragma once

#include <dds/dds.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>

#include "protocol/channel.hpp"

namespace tandem::protocol::dds {

enum class Loss : int { none, closed, silent };

class Events {
 public:
  using Listener = std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)>;

  // Counts all events. Read it, check the state, then sleep until it differs.
  std::uint64_t count() const { return count_.load(std::memory_order_acquire); }
  void sleep(std::uint64_t seen, Deadline until);

  // Sets the partner's data writer and reader, once it is chosen: events of other ends are not a loss.
  // Events of the partner before this call are not reported, so that its state has to be checked once more
  // afterwards.
  void watch(dds_instance_handle_t writer, dds_instance_handle_t reader);
  Loss loss() const { return loss_.load(std::memory_order_acquire); }

  // 0, or the DDS number of the quality-of-service policy in which an end of the run differs; a wrong type is
  // DDS_TYPE_CONSISTENCY_ENFORCEMENT_QOS_POLICY_ID.
  std::uint32_t incompatible() const { return incompatible_.load(std::memory_order_relaxed); }
  std::uint32_t samples_lost() const { return samples_lost_.load(std::memory_order_relaxed); }

  Listener listener();
  // Counts an event that no listener reports.
  void wake();

 private:
  void lose(Loss loss);

  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<dds_instance_handle_t> writer_ = 0, reader_ = 0;
  std::atomic<Loss> loss_ = Loss::none;
  std::atomic<std::uint32_t> incompatible_ = 0, samples_lost_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace tandem::protocol::dds
