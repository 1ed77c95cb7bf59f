// A look at the packets of the loopback, for which root's rights are needed.
#pragma once

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>

#include <string_view>
#include <vector>

#include "protocol/dds/network.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol::test {

// What somebody with the right to look at the interface finds in its packets.
class Wiretap {
 public:
  Wiretap() : socket_(::socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_IP);
    address.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    usable_ =
        socket_ && bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  bool usable() const { return usable_; }
  bool finds(std::string_view text) const {
    std::vector<char> packet(70'000);
    for (ssize_t n = 0; (n = recv(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT)) > 0;)
      if (std::string_view(packet.data(), static_cast<std::size_t>(n)).find(text) != std::string_view::npos)
        return true;
    return false;
  }
  // UDP packets to the ports of DDS, from the UDP header on, at most so many.
  std::vector<std::vector<char>> packets(std::size_t most) const {
    std::vector<std::vector<char>> found;
    std::vector<char> packet(70'000);
    while (found.size() < most) {
      const ssize_t n = recv(socket_.get(), packet.data(), packet.size(), MSG_DONTWAIT);
      if (n <= 0) break;
      const auto size = static_cast<std::size_t>(n), ip = static_cast<std::size_t>(packet[0] & 15) * 4;
      if (size <= ip + 8 || packet[9] != IPPROTO_UDP) continue;
      const int port =
          (static_cast<unsigned char>(packet[ip + 2]) << 8) | static_cast<unsigned char>(packet[ip + 3]);
      if (port >= dds::first_port && port <= dds::last_port)
        found.emplace_back(packet.begin() + static_cast<std::ptrdiff_t>(ip), packet.begin() + n);
    }
    return found;
  }

 private:
  Fd socket_;
  bool usable_ = false;
};

}  // namespace tandem::protocol::test
