// The channel between two hosts: Cyclone DDS over unicast UDP on one named interface.
//
// The configuration is fixed here and in code; the environment (CYCLONEDDS_URI) has no effect. Runs on one
// network are separated by their name. Each channel has its own DDS domain, so that one process may have
// several channels. These functions exist in every build; in one without Cyclone DDS they throw Error{usage}.
#pragma once

#include <memory>

#include "protocol/channel.hpp"
#include "protocol/dds/dds_options.hpp"

namespace tandem::protocol {

// Both return when each end sees the other in both directions (the start barrier). They throw Error{timeout}
// with the missing side and the addresses searched; Error{protocol} where this role of the run is taken,
// where the peer's types differ, or where it requires a secret that this end does not have; Error{usage}
// where the interface or an address is wrong.
std::unique_ptr<Channel> open_dds_coordinator(const DdsOptions& options, Deadline deadline);
std::unique_ptr<Channel> open_dds_participant(const DdsOptions& options, Deadline deadline);

}  // namespace tandem::protocol
