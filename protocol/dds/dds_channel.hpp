// The channel between two hosts: Cyclone DDS over unicast UDP on one named interface.
//
// The configuration is fixed here and in code; the environment (CYCLONEDDS_URI) has no effect. Runs on one
// network are separated by their name. Each channel has its own DDS domain, so that one process may have
// several channels. These functions exist in every build; in one without Cyclone DDS they throw Error{usage}.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/channel.hpp"
#include "protocol/messages.hpp"

namespace tandem::protocol {

struct DdsOptions {
  std::string run;                 // name of the run, the same on both ends, unique on the network
  Role role{};                     // of the participant, on both ends
  std::string interface = "lo";    // network interface that carries the run; no other is used
  std::vector<std::string> peers;  // addresses of the other end; it is enough that one end knows the other.
                                   // On "lo" 127.0.0.1 is always among them.
  std::chrono::milliseconds lease{400};  // this end counts as lost after a silence of this length
  // The secret of the run (protocol/secret.hpp): only ends that have it may take part. Without one,
  // open_dds_* throw Error{usage}, unless `insecure` admits everybody who knows the run's name.
  std::string secret;
  bool insecure = false;
  // Folder of certificates (protocol/dds/certificates.hpp): only ends of the same authority take part, and
  // everything they send is encrypted. With it, a secret may be left out. Empty: none.
  std::string certificates;
  std::function<void()> idle;  // called about every 50 ms while the other end is waited for; what it
                               // throws ends the wait
};

// Both return when each end sees the other in both directions (the start barrier). They throw Error{timeout}
// with the missing side and the addresses searched; Error{protocol} where this role of the run is taken,
// where the peer's types differ, or where it requires a secret that this end does not have; Error{usage}
// where the interface or an address is wrong.
std::unique_ptr<Channel> open_dds_coordinator(const DdsOptions& options, Deadline deadline);
std::unique_ptr<Channel> open_dds_participant(const DdsOptions& options, Deadline deadline);

}  // namespace tandem::protocol
