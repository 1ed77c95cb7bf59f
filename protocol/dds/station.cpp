#include "protocol/dds/station.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>

#include "protocol/layout.hpp"

namespace tandem::protocol::dds {

namespace {

constexpr dds_duration_t write_slice = DDS_MSECS(50);  // the longest that dds_write blocks in one go
constexpr dds_duration_t farewell = DDS_MSECS(300);    // for the last frame to arrive before this end goes
constexpr int max_matches = 2 * max_ends_per_host;

// Each channel has a domain of its own in this process. Cyclone tells domains apart by a number, which has to
// be free here and means nothing on the network (there ExternalDomainId counts).
Entity create_domain(const std::string& configuration) {
  static std::atomic<dds_domainid_t> next = 1;
  constexpr dds_domainid_t numbers = 100'000;
  for (dds_domainid_t tries = 0; tries < numbers; ++tries) {
    const dds_entity_t domain = dds_create_domain(next++ % numbers, configuration.c_str());
    if (domain != DDS_RETCODE_PRECONDITION_NOT_MET) return {domain, "start on this interface"};
  }
  throw Error(ErrorCode::resource, "all DDS domains of this process are in use", "dds");
}

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos reliable(dds_duration_t lease) {
  Qos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, write_slice);
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, lease);
  return qos;
}

Qos presence_qos(dds_duration_t lease) {
  Qos qos = reliable(lease);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  return qos;
}

Qos data_qos(dds_duration_t lease) {
  Qos qos = reliable(lease);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  // A writer that minds max_chunks_ahead never meets this limit; one that does not is refused.
  dds_qset_resource_limits(qos.get(), 2 * static_cast<int>(max_chunks_ahead), DDS_LENGTH_UNLIMITED,
                           DDS_LENGTH_UNLIMITED);
  return qos;
}

EndId end_of(dds_builtintopic_endpoint_t* endpoint) {
  EndId id{};
  if (endpoint != nullptr) {
    id = end_id(endpoint->participant_key.v);
    dds_builtintopic_free_endpoint(endpoint);
  }
  return id;
}

}  // namespace

EndId end_id(const std::uint8_t (&bytes)[16]) {
  return std::to_array(bytes);
}

Station::Station(const DdsOptions& options, Side side, const Network& network) {
  const Events::Listener listener = events_.listener();
  domain_ = create_domain(domain_configuration(network, options));

  // The participant's number within the process is that of the domain.
  dds_domainid_t number = 0;
  checked(dds_get_domainid(domain_.get(), &number), "number its domain");
  participant_ = {dds_create_participant(number, nullptr, listener.get()),
                  "join: all ports of this host may be taken, or the interface went down"};
  dds_guid_t guid;
  checked(dds_get_guid(participant_.get(), &guid), "name its participant");
  id_ = end_id(guid.v);

  // Each role has its own topics, so that mbd_server and dem_server of a run do not see each other.
  const auto topic = [&](const dds_topic_descriptor_t& type, const std::string& what) {
    const std::string name_of_topic = std::string("tandem_") + name(options.role) + "_" + what;
    return Entity(dds_create_topic(participant_.get(), &type, name_of_topic.c_str(), nullptr, nullptr),
                  "create a topic");
  };
  const bool leads = side == Side::coordinator;
  presence_topic_ = topic(tandem_dds_Presence_desc, "presence");
  out_topic_ = topic(tandem_dds_Chunk_desc, leads ? "commands" : "answers");
  in_topic_ = topic(tandem_dds_Chunk_desc, leads ? "answers" : "commands");

  // A reader takes any lease: how fast a death shows is the writer's promise.
  const dds_duration_t any_lease = DDS_INFINITY, lease = DDS_MSECS(options.lease.count());
  const Qos data_in = data_qos(any_lease), data_out = data_qos(lease);
  const Qos presence_in = presence_qos(any_lease);
  const Qos presence_out = presence_qos(lease);
  const dds_entity_t p = participant_.get();
  reader_ = {dds_create_reader(p, in_topic_.get(), data_in.get(), nullptr), "create a reader"};
  presence_reader_ = {dds_create_reader(p, presence_topic_.get(), presence_in.get(), nullptr),
                      "create a reader"};
  writer_ = {dds_create_writer(p, out_topic_.get(), data_out.get(), nullptr), "create a writer"};
  presence_writer_ = {dds_create_writer(p, presence_topic_.get(), presence_out.get(), nullptr),
                      "create a writer"};

  std::ranges::copy(id_, presence_.end);
  presence_.side = leads ? tandem_dds_coordinator_side : tandem_dds_participant_side;
  presence_.layout_hash = layout_hash;
  presence_.pid = getpid();
  gethostname(presence_.host, sizeof presence_.host - 1);
}

Station::~Station() {
  if (events_.loss() == Loss::none && writer_.get() > 0) dds_wait_for_acks(writer_.get(), farewell);
}

void Station::announce(const EndId& partner, std::uint64_t taken) {
  std::ranges::copy(partner, presence_.partner);
  presence_.taken = taken;
  const dds_return_t code = dds_write(presence_writer_.get(), &presence_);
  // Only the last value counts, and a partner that acknowledges nothing for so long is about to be lost.
  if (code != DDS_RETCODE_TIMEOUT) checked(code, "announce this end");
}

std::vector<tandem_dds_Presence> Station::present() const {
  std::array<tandem_dds_Presence, max_matches> samples;
  std::array<void*, max_matches> pointers;
  std::array<dds_sample_info_t, max_matches> infos;
  for (std::size_t i = 0; i < samples.size(); ++i) pointers[i] = &samples[i];
  const int count =
      checked(dds_read(presence_reader_.get(), pointers.data(), infos.data(), pointers.size(), max_matches),
              "read who is there");
  std::vector<tandem_dds_Presence> others;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    if (infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE && end_id(samples[i].end) != id_)
      others.push_back(samples[i]);
  return others;
}

dds_instance_handle_t Station::writer_of(const EndId& end) const {
  std::array<dds_instance_handle_t, max_matches> handles{};
  const int count =
      checked(dds_get_matched_publications(reader_.get(), handles.data(), handles.size()), "list writers");
  for (const auto handle : std::span(handles).first(std::min<std::size_t>(count, handles.size())))
    if (end_of(dds_get_matched_publication_data(reader_.get(), handle)) == end) return handle;
  return 0;
}

dds_instance_handle_t Station::reader_of(const EndId& end) const {
  std::array<dds_instance_handle_t, max_matches> handles{};
  const int count =
      checked(dds_get_matched_subscriptions(writer_.get(), handles.data(), handles.size()), "list readers");
  for (const auto handle : std::span(handles).first(std::min<std::size_t>(count, handles.size())))
    if (end_of(dds_get_matched_subscription_data(writer_.get(), handle)) == end) return handle;
  return 0;
}

}  // namespace tandem::protocol::dds
