#include "protocol/dds/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>

#include <algorithm>
#include <memory>

#include "common/error.hpp"
#include "common/utf8.hpp"

namespace tandem::protocol::dds {

namespace {

std::string text(const sockaddr* address) {
  char buffer[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, buffer, sizeof buffer);
  return buffer;
}

std::string resolve(const std::string& peer) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int code = getaddrinfo(peer.c_str(), nullptr, &wanted, &found);
  if (code != 0) {
    throw Error(ErrorCode::usage, "peer '" + shortened(peer) + "' has no IPv4 address: " + gai_strerror(code),
                "dds", "give the address or name of the other host");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(found, freeaddrinfo);
  return text(found->ai_addr);
}

std::string element(const std::string& name, const std::string& content) {
  return "<" + name + ">" + content + "</" + name + ">";
}

}  // namespace

Network find_network(const DdsOptions& options) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) throw Error(ErrorCode::resource, "cannot list the network interfaces", "dds");
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, freeifaddrs);

  Network network{options.interface, {}, {}};
  std::string usable;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if ((entry->ifa_flags & IFF_UP) == 0) continue;
    usable += (usable.empty() ? "" : ", ") + std::string(entry->ifa_name);
    if (network.address.empty() && options.interface == entry->ifa_name)
      network.address = text(entry->ifa_addr);
  }
  if (network.address.empty()) {
    throw Error(
        ErrorCode::usage,
        "interface '" + shortened(options.interface) + "' is " +
            (if_nametoindex(options.interface.c_str()) == 0 ? "unknown" : "down or has no IPv4 address"),
        "dds", "usable on this host: " + (usable.empty() ? "none" : usable));
  }
  network.peers.push_back(network.address);
  for (const std::string& peer : options.peers) {
    const std::string address = resolve(peer);
    if (std::ranges::find(network.peers, address) == network.peers.end()) network.peers.push_back(address);
  }
  return network;
}

std::string domain_configuration(const Network& network, const DdsOptions& options) {
  // The texts need no escaping: the run's name consists of letters, digits and "._-", the other texts are
  // ours.
  std::string peers;
  for (const std::string& address : network.peers) peers += "<Peer address=\"" + address + "\"/>";
  // The writers' lease must run out first: it means that the peer fell silent, this one only that the peer
  // left.
  const std::string lease = std::to_string(2 * options.lease.count()) + "ms";
  // Each announcement renews the writers' leases, so that five of them may be late before a peer counts as
  // lost.
  const std::string announce = std::to_string(std::min<std::int64_t>(options.lease.count() / 5, 1000)) + "ms";

  std::string general =
      element("Interfaces", "<NetworkInterface name=\"" + network.interface + "\" multicast=\"false\"/>") +
      element("AllowMulticast", "false");
  if (network.interface == "lo") {
    // The loopback carries 64 KiB in one packet, so that smaller fragments are not needed.
    general += element("MaxMessageSize", "65500B") + element("FragmentSize", "65000B");
  }
  return element(
      "CycloneDDS",
      element("Domain",
              element("General", general) +
                  element("Discovery",
                          element("ExternalDomainId", std::to_string(network_domain)) +
                              element("Tag", options.run) + element("ParticipantIndex", "auto") +
                              element("MaxAutoParticipantIndex", std::to_string(max_ends_per_host - 1)) +
                              element("Peers", peers) + element("LeaseDuration", lease) +
                              element("SPDPInterval", announce)) +
                  // Requests lost samples at once; the default waits for a tenth of a
                  // second.
                  element("Internal", element("NackDelay", "1ms") + element("HeartbeatInterval", "20ms") +
                                          element("Watermarks", element("WhcHigh", "1MB")) +
                                          // ~Station waits by
                                          // itself, and not for a
                                          // partner that is lost.
                                          element("WriterLingerDuration", "0s"))));
}

}  // namespace tandem::protocol::dds
