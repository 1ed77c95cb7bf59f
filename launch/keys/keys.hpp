// `tandem keys`: secrets and certificates by which the ends of a run over DDS authenticate each other and
// encrypt.
#pragma once

#include <filesystem>

namespace tandem::launch {

// Writes a new secret to a new file that only its owner can read. Throws Error{usage} where the file exists.
void write_secret(const std::filesystem::path& file);

// Writes a new folder of certificates for DDS Security, valid from now for that number of days: an authority
// (whose key is not kept, so that no more identities can be made), an identity for all ends of the run, and
// signed rules that admit only that identity and encrypt everything. Throws Error{usage} where the folder is
// not empty, or in a build without DDS.
void write_certificates(const std::filesystem::path& folder, int days);

}  // namespace tandem::launch
