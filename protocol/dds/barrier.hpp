// The start barrier: two ends find each other, agree to be a pair, and see each other's data in both
// directions before either continues. DDS loses data that is written before a reader has matched.
#pragma once

#include <string>

#include "protocol/dds/station.hpp"

namespace tandem::protocol::dds {

struct Partner {
  tandem_dds_Presence presence{};
  std::string name;  // "dem_server (pid 1234 on nodeb)"
  EndId id() const { return end_id(presence.end); }
};

Partner join(Station& station, const DdsOptions& options, Side side, const Network& network,
             Deadline deadline);

}  // namespace tandem::protocol::dds
