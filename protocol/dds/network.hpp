// The one network interface that a channel uses, and the configuration of Cyclone DDS that keeps to it.
#pragma once

#include <string>
#include <vector>

#include "protocol/dds/dds_channel.hpp"

namespace tandem::protocol::dds {

// DDS domain number on the network. It sets the UDP ports (docs/distributed.md) and keeps clear of 0, where
// other DDS systems live.
inline constexpr int network_domain = 42;
// Ends on one host; each has its own pair of ports, and each port of each peer is tried.
inline constexpr int max_ends_per_host = 24;
// By the rule of the DDS wire protocol: 7400 + 250 domain, then 10 + 2 end for discovery and 11 + 2 end for
// data.
inline constexpr int first_port = 7400 + 250 * network_domain + 10;
inline constexpr int last_port = first_port + 2 * max_ends_per_host - 1;

struct Network {
  std::string interface;           // that is up
  std::string address;             // its IPv4 address
  std::vector<std::string> peers;  // addresses where ends are looked for, this host first
};

// Looks at the interface and resolves the peers; Error{usage} says what is wrong and which interfaces there
// are.
Network find_network(const DdsOptions& options);

// Everything that differs from Cyclone's defaults, as its XML.
std::string domain_configuration(const Network& network, const DdsOptions& options);

}  // namespace tandem::protocol::dds
