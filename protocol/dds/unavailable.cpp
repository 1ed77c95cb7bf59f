// Replaces the channel in a build without Cyclone DDS.
#include "common/error.hpp"
#include "protocol/dds/dds_channel.hpp"

namespace tandem::protocol {

namespace {
Error unavailable() {
  return Error(ErrorCode::usage, "this build has no DDS", "dds",
               "install cyclonedds-dev and cyclonedds-tools, configure with TANDEM_DDS=ON and build again");
}
}  // namespace

std::unique_ptr<Channel> open_dds_coordinator(const DdsOptions&, Deadline) {
  throw unavailable();
}
std::unique_ptr<Channel> open_dds_participant(const DdsOptions&, Deadline) {
  throw unavailable();
}

}  // namespace tandem::protocol
