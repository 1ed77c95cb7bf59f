// An end of a run of bare Cyclone calls, which knows all but the secret, and believes and sends what it
// likes.
#pragma once

#include <dds/dds.h>

#include <cstring>
#include <string>
#include <vector>

#include "protocol/dds/network.hpp"
#include "wire.h"

namespace tandem::protocol::test {

class IntruderEnd {
 public:
  explicit IntruderEnd(const DdsOptions& run) {
    const std::string configuration = dds::domain_configuration(dds::find_network(run), run);
    domain_ = dds_create_domain(200'000, configuration.c_str());
    participant_ = dds_create_participant(200'000, nullptr, nullptr);
    dds_guid_t guid;
    dds_get_guid(participant_, &guid);
    std::memcpy(id, guid.v, sizeof id);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    const std::string topic = std::string("tandem_") + name(run.role) + "_";
    answers = writer(tandem_dds_Chunk_desc, topic + "answers", qos);
    commands = writer(tandem_dds_Chunk_desc, topic + "commands", qos);
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    presences = writer(tandem_dds_Presence_desc, topic + "presence", qos);
    reader_ = dds_create_reader(participant_,
                                dds_create_topic(participant_, &tandem_dds_Presence_desc,
                                                 (topic + "presence").c_str(), nullptr, nullptr),
                                qos, nullptr);
    dds_delete_qos(qos);
  }
  ~IntruderEnd() { dds_delete(domain_); }
  IntruderEnd(const IntruderEnd&) = delete;
  IntruderEnd& operator=(const IntruderEnd&) = delete;

  std::vector<tandem_dds_Presence> heard() const {
    std::vector<tandem_dds_Presence> samples(1000);
    std::vector<void*> pointers;
    for (auto& sample : samples) pointers.push_back(&sample);
    std::vector<dds_sample_info_t> infos(samples.size());
    const int count = dds_read(reader_, pointers.data(), infos.data(), samples.size(), 1000);
    std::vector<tandem_dds_Presence> others;
    for (int i = 0; i < count; ++i)
      if (infos[i].valid_data && std::memcmp(samples[i].end, id, sizeof id) != 0)
        others.push_back(samples[i]);
    return others;
  }

  tandem_dds_EndId id{};
  dds_entity_t answers = 0, commands = 0, presences = 0;

  // Is sent all that the coordinator says.
  void read_along(const DdsOptions& run) const {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
    const std::string topic = std::string("tandem_") + name(run.role) + "_commands";
    dds_create_reader(participant_,
                      dds_create_topic(participant_, &tandem_dds_Chunk_desc, topic.c_str(), nullptr, nullptr),
                      qos, nullptr);
    dds_delete_qos(qos);
  }

 private:
  dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& topic,
                      const dds_qos_t* qos) const {
    return dds_create_writer(
        participant_, dds_create_topic(participant_, &type, topic.c_str(), nullptr, nullptr), qos, nullptr);
  }
  dds_entity_t domain_ = 0, participant_ = 0, reader_ = 0;
};

}  // namespace tandem::protocol::test
