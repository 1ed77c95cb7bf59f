// Replaces certificates.cpp in a build without Cyclone DDS.
#include "common/error.hpp"
#include "launch/keys/keys.hpp"

namespace tandem::launch {

void write_certificates(const std::filesystem::path&, int) {
  throw Error(ErrorCode::usage, "this build has no DDS, for which the certificates would be", "keys",
              "install cyclonedds-dev and cyclonedds-tools, configure with TANDEM_DDS=ON and build again");
}

}  // namespace tandem::launch
