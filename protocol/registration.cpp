#include "protocol/registration.hpp"

#include <algorithm>
#include <cstdio>

#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

std::string text(Version v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor);
}

std::string hex(std::uint64_t value) {
  char buffer[20];
  std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(value));
  return buffer;
}

}  // namespace

std::string versions_of(std::span<const Dialect> spoken) {
  std::string list;
  for (const Dialect& dialect : spoken) {
    const bool last = &dialect == &spoken.back();
    list += (list.empty() ? "" : last ? " and " : ", ") + text(dialect.version);
  }
  return list;
}

std::string capability_names(std::uint64_t capabilities) {
  std::string list;
  const auto add = [&](Capability bit, const char* capability) {
    if (capabilities & bit) list += (list.empty() ? "" : ", ") + std::string(capability);
    capabilities &= ~std::uint64_t{bit};
  };
  add(can_predict, "can_predict");
  add(can_rollback, "can_rollback");
  add(can_interpolate, "can_interpolate");
  add(can_window_mean, "can_window_mean");
  add(can_linearise, "can_linearise");
  add(can_extrapolate, "can_extrapolate");
  add(can_control, "can_control");
  add(can_checkpoint, "can_checkpoint");
  add(can_observe_elements, "can_observe_elements");
  add(can_measure, "can_measure");
  add(can_observe_contacts, "can_observe_contacts");
  add(can_observe_walls, "can_observe_walls");
  add(can_snapshot, "can_snapshot");
  add(can_observe_liquid, "can_observe_liquid");
  add(can_respond, "can_respond");
  if (capabilities != 0) list += (list.empty() ? "bits " : ", bits ") + hex(capabilities);
  return list.empty() ? "none" : list;
}

std::uint64_t capabilities_of(Role role) {
  return role == Role::mbd ? can_predict | can_rollback : can_rollback | can_interpolate | can_window_mean;
}

Version admit(const Hello& hello, Version version, Role role, std::uint64_t needed, const std::string& peer,
              std::span<const Dialect> spoken) {
  const Version ours = spoken.front().version;
  const auto refuse = [&](Violation violation, const std::string& problem, const std::string& hint) {
    throw ProtocolError(violation, problem, peer, hint);
  };
  if (hello.role != role)
    refuse(Violation::wrong_role,
           "role is " + std::string(name(hello.role)) + ", the run needs " + name(role) + " here",
           std::string("give it to --") + word_of(hello.role) +
               "-server, or attach the other server to this channel");
  const auto dialect = std::ranges::find(spoken, version, &Dialect::version);
  if (dialect == spoken.end())
    refuse(Violation::wrong_version,
           "protocol version is " + text(version) + ", the coordinator speaks " + versions_of(spoken),
           version.major > ours.major || (version.major == ours.major && version.minor > ours.minor)
               ? "use a coordinator of that version or newer"
               : "update the participant");
  if (hello.layout_hash != dialect->layout_hash)
    refuse(Violation::wrong_layout,
           "layout hash of protocol " + text(version) + " is " + hex(hello.layout_hash) +
               ", the coordinator has " + hex(dialect->layout_hash),
           "build both sides from the same release");
  if (const std::uint64_t missing = needed & ~hello.capabilities; missing != 0)
    refuse(Violation::missing_capability,
           "capabilities are " + capability_names(hello.capabilities) + ", the run needs " +
               capability_names(needed) + ": missing " + capability_names(missing),
           "choose a coupling scheme that does without, or another participant");
  return version;
}

}  // namespace tandem::protocol
