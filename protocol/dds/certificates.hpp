// The folder of certificates that switches DDS Security on: `tandem keys --certificates DIR` makes it.
#pragma once

#include <string>

struct dds_qos;

namespace tandem::protocol {

namespace certificate_files {
inline constexpr const char *authority = "authority.pem", *identity = "identity.pem",
                            *key = "identity_key.pem", *governance = "governance.p7s",
                            *permissions = "permissions.p7s";
}  // namespace certificate_files

namespace dds {

// Makes a participant authenticate itself, accept only others of the same authority, and encrypt everything.
// Throws Error{usage} where a file is missing or others can read the key, Error{resource} where this
// installation has no plug-ins.
void use_certificates(dds_qos* participant, const std::string& folder);

}  // namespace dds

}  // namespace tandem::protocol
