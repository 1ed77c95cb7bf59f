#include "coordinator/scene/options.hpp"

#include <cstdlib>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"
#include "protocol/secret.hpp"

namespace tandem::launch {

const char* name(Transport transport) {
  switch (transport) {
    case Transport::shm:
      return "shm";
    case Transport::inproc:
      return "inproc";
    case Transport::dds:
      return "dds";
    case Transport::stream:
      return "stream";
  }
  return "unknown";
}

const char* dds_security(const RunOptions& options) {
  if (options.insecure) return "none";
  if (options.certificates.empty()) return "secret";
  const bool secret =
      !options.attach || !options.secret_file.empty() || std::getenv(protocol::secret_variable) != nullptr;
  return secret ? "certificates, secret" : "certificates";
}

Estimate parse_estimate(const std::string& word) {
  if (word == "default") return Estimate::standard;
  if (word == "richardson") return Estimate::richardson;
  throw Error(ErrorCode::usage, "there is no estimate '" + shortened(word) + "'", "--estimate",
              suggest_name(word, {"default", "richardson"}, "estimates"));
}

}  // namespace tandem::launch
