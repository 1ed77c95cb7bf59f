#include "protocol/dds/station.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>

#include "protocol/dds/certificates.hpp"
#include "protocol/dds/cyclone_log.hpp"
#include "protocol/layout.hpp"

namespace tandem::protocol::dds {

namespace {

constexpr dds_duration_t write_slice = DDS_MSECS(50);  // the longest time that dds_write blocks at once
constexpr dds_duration_t farewell = DDS_MSECS(300);    // for the last frame to arrive before this end closes
// Maximum number of authenticated ends of this run: present ones, and recordings of earlier ones.
constexpr std::size_t max_present = 256;

// Each channel has a domain of its own in this process. Cyclone identifies domains by a number, which must be
// unused in the process and has no meaning on the network (there ExternalDomainId counts).
Entity create_domain(const std::string& configuration) {
  static std::atomic<dds_domainid_t> next = 1;
  constexpr dds_domainid_t numbers = 230;  // the largest number that rules of DDS Security can name
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
  // A writer that respects max_chunks_ahead never reaches this limit; one that does not is refused.
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

// All handles that `list` returns, whatever their number.
template <class List>
std::vector<dds_instance_handle_t> all_matches(const List& list, const char* deed) {
  std::vector<dds_instance_handle_t> handles(16);
  for (;;) {
    const auto count = static_cast<std::size_t>(checked(list(handles.data(), handles.size()), deed));
    if (count <= handles.size()) {
      handles.resize(count);
      return handles;
    }
    handles.resize(2 * count);
  }
}

}  // namespace

std::string name_of(const tandem_dds_Presence& end, Role role) {
  return std::string(end.side == tandem_dds_coordinator_side ? "coordinator" : name(role)) + " (pid " +
         std::to_string(end.pid) + " on " + std::string(end.host, strnlen(end.host, sizeof end.host)) + ")";
}

EndId end_id(const std::uint8_t (&bytes)[16]) {
  return std::to_array(bytes);
}

Entity Station::topic(const dds_topic_descriptor_t& type, const char* what, Role role) const {
  const std::string name_of_topic = std::string("tandem_") + name(role) + "_" + what;
  return {dds_create_topic(participant_.get(), &type, name_of_topic.c_str(), nullptr, nullptr),
          "create a topic"};
}

// Called by Cyclone's threads for each presence that arrives. One that fails authentication uses no memory
// and no entry.
void Station::hear(const tandem_dds_Presence& presence, dds_instance_handle_t writer) {
  if (end_id(presence.end) == id_) return;
  if (proof_.holds(presence)) {
    {
      const std::lock_guard lock(heard_mutex_);
      if (heard_.size() < max_present || heard_.contains(writer)) heard_[writer] = presence;
    }
    events_.wake();
    return;
  }
  strangers_.report(name_of(presence, role_), presence.asks == tandem_dds_secret_proof
                                                  ? "its secret is not this run's"
                                                  : "it has no secret, and this run requires one");
}

Station::Station(const DdsOptions& options, Side side, const Network& network)
    : role_(options.role), proof_(options.secret, options.run, options.role) {
  const Events::Listener listener = events_.listener();
  take_cyclone_lines();
  domain_ = create_domain(domain_configuration(network, options));

  // Cyclone's number of the participant within the process is that of the domain.
  dds_domainid_t number = 0;
  checked(dds_get_domainid(domain_.get(), &number), "number its domain");
  const Qos own(dds_create_qos(), dds_delete_qos);
  if (!options.certificates.empty()) use_certificates(own.get(), options.certificates);
  participant_ = {dds_create_participant(number, own.get(), listener.get()),
                  options.certificates.empty()
                      ? "join: all ports of this host may be taken, or the interface went down"
                      : "join: the certificates may have run out, or not belong together"};
  dds_guid_t guid;
  checked(dds_get_guid(participant_.get(), &guid), "name its participant");
  id_ = end_id(guid.v);

  // Each role has its own topics, so that mbd_server and dem_server of a run do not see each other.
  const bool leads = side == Side::coordinator;
  presence_out_topic_ = topic(tandem_dds_Presence_desc, "presence", role_);
  presence_in_topic_ = topic(tandem_dds_Presence_desc, "presence", role_);
  out_topic_ = topic(tandem_dds_Chunk_desc, leads ? "commands" : "answers", role_);
  in_topic_ = topic(tandem_dds_Chunk_desc, leads ? "answers" : "commands", role_);

  // The reader itself keeps no presence: there a recording that a stranger sends again, or disposes of, would
  // replace what the end itself has said.
  dds_topic_filter heard{};
  heard.mode = DDS_TOPIC_FILTER_SAMPLE_SAMPLEINFO_ARG;
  heard.f.sample_sampleinfo_arg = [](const void* sample, const dds_sample_info_t* info, void* self) {
    static_cast<Station*>(self)->hear(*static_cast<const tandem_dds_Presence*>(sample),
                                      info->publication_handle);
    return false;
  };
  heard.arg = this;
  checked(dds_set_topic_filter_extended(presence_in_topic_.get(), &heard), "filter presences");
  // Filters by the writer that DDS reports, not by the sender that the sample claims.
  dds_topic_filter accepted{};
  accepted.mode = DDS_TOPIC_FILTER_SAMPLEINFO_ARG;
  accepted.f.sampleinfo_arg = [](const dds_sample_info_t* info, void* self) {
    Station& station = *static_cast<Station*>(self);
    if (info->publication_handle == station.accepted_) return true;
    station.strangers_.report("an end that is not in the run", "it sent data");
    return false;
  };
  accepted.arg = this;
  checked(dds_set_topic_filter_extended(in_topic_.get(), &accepted), "filter data");

  // A reader accepts any lease: the writer promises how fast its death is detected.
  const dds_duration_t any_lease = DDS_INFINITY, lease = DDS_MSECS(options.lease.count());
  const Qos data_in = data_qos(any_lease), data_out = data_qos(lease);
  const Qos presence_in = presence_qos(any_lease);
  const Qos presence_out = presence_qos(lease);
  const dds_entity_t p = participant_.get();
  reader_ = {dds_create_reader(p, in_topic_.get(), data_in.get(), nullptr), "create a reader"};
  presence_reader_ = {dds_create_reader(p, presence_in_topic_.get(), presence_in.get(), nullptr),
                      "create a reader"};
  writer_ = {dds_create_writer(p, out_topic_.get(), data_out.get(), nullptr), "create a writer"};
  presence_writer_ = {dds_create_writer(p, presence_out_topic_.get(), presence_out.get(), nullptr),
                      "create a writer"};

  std::ranges::copy(id_, presence_.end);
  std::ranges::copy(nonce_, presence_.own_nonce);
  presence_.side = leads ? tandem_dds_coordinator_side : tandem_dds_participant_side;
  presence_.layout_hash = layout_hash;
  presence_.pid = getpid();
  gethostname(presence_.host, sizeof presence_.host - 1);
}

Station::~Station() {
  if (events_.loss() == Loss::none && writer_.get() > 0) dds_wait_for_acks(writer_.get(), farewell);
}

void Station::announce(const tandem_dds_Presence* partner, std::uint64_t taken) {
  std::ranges::copy(partner != nullptr ? end_id(partner->end) : EndId{}, presence_.partner);
  std::ranges::copy(partner != nullptr ? std::to_array(partner->own_nonce) : Nonce{},
                    presence_.partner_nonce);
  presence_.taken = taken;
  proof_.sign(presence_);
  const dds_return_t code = dds_write(presence_writer_.get(), &presence_);
  // Only the last value counts, and a partner that acknowledges nothing for that long is about to be lost.
  if (code != DDS_RETCODE_TIMEOUT) checked(code, "announce this end");
}

const std::vector<tandem_dds_Presence>& Station::present() {
  const auto all = [this] {
    const std::lock_guard lock(heard_mutex_);
    return heard_;
  }();
  present_.clear();
  for (const auto& [writer, presence] : all) {
    // Without the lock: DDS has locks of its own here, and hear() is called under some of them.
    if (end_of(dds_get_matched_publication_data(presence_reader_.get(), writer)) == end_id(presence.end)) {
      present_.push_back(presence);
      continue;
    }
    const std::lock_guard lock(heard_mutex_);
    heard_.erase(writer);
  }
  return present_;
}

dds_instance_handle_t Station::writer_of(const EndId& end) const {
  const auto handles = all_matches(
      [&](auto* list, std::size_t size) { return dds_get_matched_publications(reader_.get(), list, size); },
      "list writers");
  for (const auto handle : handles)
    if (end_of(dds_get_matched_publication_data(reader_.get(), handle)) == end) return handle;
  return 0;
}

std::size_t Station::readers() const {
  return static_cast<std::size_t>(
      checked(dds_get_matched_subscriptions(writer_.get(), nullptr, 0), "count readers"));
}

dds_instance_handle_t Station::reader_of(const EndId& end) const {
  const auto handles = all_matches(
      [&](auto* list, std::size_t size) { return dds_get_matched_subscriptions(writer_.get(), list, size); },
      "list readers");
  for (const auto handle : handles)
    if (end_of(dds_get_matched_subscription_data(writer_.get(), handle)) == end) return handle;
  return 0;
}

}  // namespace tandem::protocol::dds
