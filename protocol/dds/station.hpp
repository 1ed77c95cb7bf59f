// The DDS entities of one end of a channel: its own domain, one participant, three topics.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/dds/dds_options.hpp"
#include "protocol/dds/entity.hpp"
#include "protocol/dds/events.hpp"
#include "protocol/dds/network.hpp"
#include "protocol/dds/proof.hpp"
#include "protocol/dds/strangers.hpp"
#include "wire.h"

namespace tandem::protocol::dds {

enum class Side { coordinator, participant };

using EndId = std::array<std::uint8_t, 16>;
EndId end_id(const std::uint8_t (&bytes)[16]);
// "dem_server (pid 1234 on nodeb)": the name of an end of this role in messages.
std::string name_of(const tandem_dds_Presence& end, Role role);

// Maximum number of chunks by which a writer may be ahead of the reader's user; it bounds the memory of both.
inline constexpr std::uint64_t max_chunks_ahead = 64;

class Station {
 public:
  Station(const DdsOptions& options, Side side, const Network& network);
  // Waits a moment for the last written data to arrive.
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  const EndId& id() const { return id_; }
  Events& events() { return events_; }
  const Events& events() const { return events_; }
  dds_entity_t writer() const { return writer_.get(); }
  dds_entity_t reader() const { return reader_.get(); }

  const Nonce& nonce() const { return nonce_; }
  bool requires_proof() const { return proof_.has_secret(); }
  Strangers& strangers() { return strangers_; }

  // Announces to all ends of this role in the run the partner of this end and the number of chunks taken.
  void announce(const tandem_dds_Presence* partner, std::uint64_t taken);
  // All other ends alive that are authenticated: the tag is valid, where a secret is used, and the writer
  // that DDS reports is the end's own.
  const std::vector<tandem_dds_Presence>& present();
  // From now on the reader takes data of this writer only. Before, it takes none.
  void accept_from(dds_instance_handle_t writer) { accepted_ = writer; }

  // Handles of the data writer and reader of `end` that match ours, 0 where there is none yet.
  dds_instance_handle_t writer_of(const EndId& end) const;
  dds_instance_handle_t reader_of(const EndId& end) const;
  // Number of readers that receive the data written here.
  std::size_t readers() const;

 private:
  Entity topic(const dds_topic_descriptor_t& type, const char* what, Role role) const;
  void hear(const tandem_dds_Presence& presence, dds_instance_handle_t writer);

  Role role_;
  EndId id_{};
  Nonce nonce_ = fresh_nonce();
  PresenceProof proof_;
  Strangers strangers_;
  std::atomic<dds_instance_handle_t> accepted_ = 0;
  tandem_dds_Presence presence_{};
  std::mutex heard_mutex_;
  std::map<dds_instance_handle_t, tandem_dds_Presence> heard_;  // the last of each writer
  std::vector<tandem_dds_Presence> present_;
  Events events_;  // must outlive the entities, whose listeners use it
  Entity domain_, participant_;
  // Presences are written and read by two topics of one name, so that the filter applies to reading only.
  Entity presence_out_topic_, presence_in_topic_, out_topic_, in_topic_;
  Entity presence_writer_, presence_reader_, writer_, reader_;
};

}  // namespace tandem::protocol::dds
