#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

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

}  // namespace tandem::protocol
