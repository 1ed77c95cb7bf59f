// The channel between two hosts: Cyclone DDS over unicast UDP on one named interface.
//
// Everything is configured here and in code; the environment (CYCLONEDDS_URI) changes nothing. Runs on one
// network are kept apart by their name. Each channel brings its own DDS domain, so that one process may hold
// several. These functions exist in every build; in one without Cyclone DDS they throw Error{usage}.
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
  std::chrono::milliseconds lease{400};  // this end counts as lost when it is silent for so long
  // Who may take part: all ends that have this secret (protocol/secret.hpp). Without one, open_dds_* throw
  // Error{usage}, unless `insecure` says that whoever knows the run's name may.
  std::string secret;
  bool insecure = false;
  // Folder of certificates (protocol/dds/certificates.hpp): only ends of the same authority take part, and
  // all that they say is encrypted. With it, a secret may be left out. Empty: none.
  std::string certificates;
  std::function<void()> idle;  // called about every 50 ms while the other end is waited for; what it
                               // throws ends the wait
};

// Both return when each end sees the other in both directions (the start barrier), or throw:
// Error{timeout} says which side was missing and where it was looked for; Error{protocol} that this role of
// the run is taken, that the peer's types differ, or that it asks for a secret that this end has not;
// Error{usage} that the interface or an address is wrong.
std::unique_ptr<Channel> open_dds_coordinator(const DdsOptions& options, Deadline deadline);
std::unique_ptr<Channel> open_dds_participant(const DdsOptions& options, Deadline deadline);

}  // namespace tandem::protocol
