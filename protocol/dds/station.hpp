// The DDS entities of one end of a channel: its own domain, one participant, three topics.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "protocol/dds/dds_channel.hpp"
#include "protocol/dds/entity.hpp"
#include "protocol/dds/events.hpp"
#include "protocol/dds/network.hpp"
#include "wire.h"

namespace tandem::protocol::dds {

enum class Side { coordinator, participant };

using EndId = std::array<std::uint8_t, 16>;
EndId end_id(const std::uint8_t (&bytes)[16]);

// How far a writer may be ahead of the user of the other end [chunks]; bounds the memory of both.
inline constexpr std::uint64_t max_chunks_ahead = 64;

class Station {
 public:
  Station(const DdsOptions& options, Side side, const Network& network);
  // Gives what was written last a moment to arrive.
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  const EndId& id() const { return id_; }
  Events& events() { return events_; }
  const Events& events() const { return events_; }
  dds_entity_t writer() const { return writer_.get(); }
  dds_entity_t reader() const { return reader_.get(); }

  // Tells all ends of this role of the run whom this one has joined and how much of it was taken.
  void announce(const EndId& partner, std::uint64_t taken);
  // Of all other ends alive.
  std::vector<tandem_dds_Presence> present() const;

  // Handles of the data writer and reader of `end` that match ours, 0 where there is none yet.
  dds_instance_handle_t writer_of(const EndId& end) const;
  dds_instance_handle_t reader_of(const EndId& end) const;

 private:
  EndId id_{};
  tandem_dds_Presence presence_{};
  Events events_;  // outlives the entities, whose listeners use it
  Entity domain_, participant_;
  Entity presence_topic_, out_topic_, in_topic_;
  Entity presence_writer_, presence_reader_, writer_, reader_;
};

}  // namespace tandem::protocol::dds
