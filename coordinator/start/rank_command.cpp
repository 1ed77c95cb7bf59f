#include "coordinator/start/rank_command.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <netdb.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/start/build_info.hpp"

namespace tandem::launch {
namespace {

constexpr const char* program_of_ranks = "dem_server_mpi";

[[noreturn]] void refuse(const std::string& problem, const std::string& remedy) {
  throw Error(ErrorCode::usage, problem, "--ranks", remedy);
}

std::string text_of(const sockaddr* address) {
  char text[NI_MAXHOST]{};
  const bool is_v6 = address->sa_family == AF_INET6;
  if (!is_v6 && address->sa_family != AF_INET) return "none";
  return getnameinfo(address, is_v6 ? sizeof(sockaddr_in6) : sizeof(sockaddr_in), text, sizeof text, nullptr,
                     0, NI_NUMERICHOST) == 0
             ? text
             : "none";
}

// Whether a name, or an address, is one of this host.
bool is_this_host(const std::string& name) {
  char own[256]{};
  gethostname(own, sizeof own - 1);
  const auto short_form = [](std::string_view host) { return host.substr(0, host.find('.')); };
  if (name == own || name == "localhost") return true;
  addrinfo* found = nullptr;
  ifaddrs* interfaces = nullptr;
  if (getaddrinfo(name.c_str(), nullptr, nullptr, &found) != 0) return short_form(name) == short_form(own);
  bool is_own = false;
  if (getifaddrs(&interfaces) == 0)
    for (const ifaddrs* at = interfaces; at != nullptr; at = at->ifa_next)
      for (const addrinfo* address = found; address != nullptr; address = address->ai_next)
        is_own |= at->ifa_addr != nullptr && text_of(at->ifa_addr) != "none" &&
                  text_of(at->ifa_addr) == text_of(address->ai_addr);
  freeifaddrs(interfaces);
  freeaddrinfo(found);
  return is_own;
}

void expect_hosts(const RunOptions& options) {
  const auto refuse_hosts = [](const std::string& problem, const std::string& remedy) {
    throw Error(ErrorCode::usage, problem, "--hosts", remedy);
  };
  const std::vector<std::string>& hosts = options.hosts;
  if (hosts.empty()) return;
  if (options.ranks == 1)
    refuse_hosts("hosts are those of several ranks", "give --ranks, or leave --hosts out");
  if (hosts.size() > static_cast<std::size_t>(options.ranks))
    refuse_hosts(fmt::format("{} ranks cannot be on {} hosts", options.ranks, hosts.size()),
                 "give at least one rank for each host");
  for (const std::string& host : hosts) {
    const bool is_name =
        !host.empty() && host.front() != '-' &&
        host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") ==
            std::string::npos;
    if (!is_name)
      refuse_hosts(fmt::format("'{}' is no name of a host", printable(shortened(host))), "write node1,node2");
    if (std::ranges::count(hosts, host) > 1)
      refuse_hosts(fmt::format("'{}' is given twice", host),
                   "give each host once: ranks are spread over all");
  }
  if (!is_this_host(hosts.front()))
    refuse_hosts(fmt::format("'{}' is not this host, on which rank 0 has to be", hosts.front()),
                 "give this host first, by a name or an address that the others know");
}

void expect_program() {
  const std::filesystem::path program = program_folder() / program_of_ranks;
  if (!has_mpi)
    refuse("this build of tandem has no MPI, which several ranks need",
           "run launch/install and launch/build, which find Debian's OpenMPI, or leave --ranks out");
  if (access(program.c_str(), X_OK) != 0)
    refuse(fmt::format("{} is not there", program.string()),
           "build it, or install all programs of tandem into one folder");
  if (access(mpirun, X_OK) != 0)
    refuse(fmt::format("{}, which starts the ranks, is not there", mpirun),
           "install openmpi-bin, or leave --ranks out");
}

}  // namespace

void expect_ranks(const RunOptions& options) {
  expect_hosts(options);
  if (options.ranks == 1) return;
  if (options.ranks < 1 || options.ranks > most_ranks)
    refuse(fmt::format("{} is no number of ranks", options.ranks),
           fmt::format("give 1 to {}; 1 is one process with threads", most_ranks));
  if (options.transport != Transport::shm || options.attach)
    refuse("several ranks are started from here and reached over shared memory so far",
           "leave --transport and --attach out");
  expect_program();
}

void expect_ranks(const RunOptions& options, const scene::Scene& scene, const ForeignServers& foreign) {
  if (options.ranks == 1) return;
  if (!scene.dem)
    refuse("the scene has no spheres, and only dem_server runs on several ranks", "leave --ranks out");
  if (foreign.of(protocol::Role::dem))
    refuse("several ranks are those of dem_server, and another program computes the spheres of this run",
           "leave one of the two out");
}

Command start_of_ranks(const RunOptions& options, const std::vector<std::string>& arguments) {
  Command command;
  command.name = fmt::format("dem_server on {} ranks", options.ranks);
  command.program = mpirun;
  // The ranks wait for each other in each micro step: where they share cores, a waiting one must yield.
  // Their threads use all cores that the run may use, not one each.
  command.arguments = {"-n", std::to_string(options.ranks), "--oversubscribe", "--bind-to", "none"};
  const auto set = [&](const char* parameter, const char* value) {
    command.arguments.insert(command.arguments.end(), {"--mca", parameter, value});
  };
  set("mpi_yield_when_idle", "1");
  // Copies between processes of a host need a right that containers lack.
  if (options.hosts.empty()) {
    set("btl", "self,vader");  // one host: no network
  } else {
    const std::size_t hosts = options.hosts.size(),
                      of_each = (static_cast<std::size_t>(options.ranks) + hosts - 1) / hosts;
    std::string list;
    for (const std::string& host : options.hosts)
      list += fmt::format("{}{}:{}", list.empty() ? "" : ",", host, of_each);
    command.arguments.insert(command.arguments.end(), {"--host", list});
  }
  set("btl_vader_single_copy_mechanism", "none");
  set("odls_base_sigkill_timeout", "0");  // where one rank has died, the others end at once
  if (geteuid() == 0) command.arguments.push_back("--allow-run-as-root");
  command.arguments.push_back((program_folder() / program_of_ranks).string());
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.foreign = true;  // its children end with it
  return command;
}

}  // namespace tandem::launch
