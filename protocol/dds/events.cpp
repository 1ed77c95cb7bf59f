#include "protocol/dds/events.hpp"

namespace tandem::protocol::dds {

namespace {
Events& events(void* argument) {
  return *static_cast<Events*>(argument);
}
}  // namespace

void Events::wake() {
  {
    // Under the lock: a thread between reading the count and sleeping would otherwise miss this.
    const std::lock_guard lock(mutex_);
    count_.fetch_add(1, std::memory_order_release);
  }
  changed_.notify_one();
}

void Events::sleep(std::uint64_t seen, Deadline until) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, until, [&] { return count() != seen; });
}

void Events::watch(dds_instance_handle_t writer, dds_instance_handle_t reader) {
  loss_ = Loss::none;
  writer_ = writer;
  reader_ = reader;
}

void Events::lose(Loss loss) {
  // Latched: the first reason is kept, and a peer that returns is too late.
  Loss none = Loss::none;
  loss_.compare_exchange_strong(none, loss);
}

Events::Listener Events::listener() {
  Listener listener(dds_create_listener(this), dds_delete_listener);
  dds_lset_data_available(listener.get(), [](dds_entity_t, void* self) { events(self).wake(); });
  dds_lset_liveliness_changed(
      listener.get(), [](dds_entity_t, const dds_liveliness_changed_status_t status, void* self) {
        Events& e = events(self);
        if (status.not_alive_count_change > 0 && status.last_publication_handle == e.writer_)
          e.lose(Loss::silent);
        e.wake();
      });
  dds_lset_subscription_matched(
      listener.get(), [](dds_entity_t, const dds_subscription_matched_status_t status, void* self) {
        Events& e = events(self);
        if (status.current_count_change < 0 && status.last_publication_handle == e.writer_)
          e.lose(Loss::closed);
        e.wake();
      });
  dds_lset_publication_matched(
      listener.get(), [](dds_entity_t, const dds_publication_matched_status_t status, void* self) {
        Events& e = events(self);
        if (status.current_count_change < 0 && status.last_subscription_handle == e.reader_)
          e.lose(Loss::closed);
        e.wake();
      });
  dds_lset_requested_incompatible_qos(
      listener.get(), [](dds_entity_t, const dds_requested_incompatible_qos_status_t status, void* self) {
        events(self).incompatible_ = status.last_policy_id;
        events(self).wake();
      });
  dds_lset_offered_incompatible_qos(
      listener.get(), [](dds_entity_t, const dds_offered_incompatible_qos_status_t status, void* self) {
        events(self).incompatible_ = status.last_policy_id;
        events(self).wake();
      });
  dds_lset_inconsistent_topic(listener.get(),
                              [](dds_entity_t, const dds_inconsistent_topic_status_t, void* self) {
                                events(self).incompatible_ = DDS_TYPE_CONSISTENCY_ENFORCEMENT_QOS_POLICY_ID;
                                events(self).wake();
                              });
  dds_lset_sample_lost(listener.get(), [](dds_entity_t, const dds_sample_lost_status_t status, void* self) {
    events(self).samples_lost_ = status.total_count;
    events(self).wake();
  });
  dds_lset_sample_rejected(listener.get(),
                           [](dds_entity_t, const dds_sample_rejected_status_t status, void* self) {
                             events(self).samples_lost_ = status.total_count;
                             events(self).wake();
                           });
  return listener;
}

}  // namespace tandem::protocol::dds
