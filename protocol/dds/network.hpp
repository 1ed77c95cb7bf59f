// The one network interface that a channel uses, and the configuration that restricts Cyclone DDS to it.
#pragma once

#include <string>
#include <vector>

#include "protocol/dds/dds_channel.hpp"

namespace tandem::protocol::dds {

// DDS domain number on the network. It determines the UDP ports (docs/distributed.md) and differs from 0,
// which other DDS systems use.
inline constexpr int network_domain = 42;
// Maximum number of ends on one host; each has its own pair of ports, and each port of each peer is tried.
inline constexpr int max_ends_per_host = 24;
// From the DDS wire protocol: 7400 + 250 domain, then 10 + 2 end for discovery and 11 + 2 end for data.
inline constexpr int first_port = 7400 + 250 * network_domain + 10;
inline constexpr int last_port = first_port + 2 * max_ends_per_host - 1;

struct Network {
  std::string interface;           // name of an active interface
  std::string address;             // its IPv4 address
  std::vector<std::string> peers;  // addresses to search for ends, this host first
};

// Checks the interface and resolves the peers; throws Error{usage} with the fault and the existing
// interfaces.
Network find_network(const DdsOptions& options);

// All settings that differ from Cyclone's defaults, as its XML.
std::string domain_configuration(const Network& network, const DdsOptions& options);

}  // namespace tandem::protocol::dds
