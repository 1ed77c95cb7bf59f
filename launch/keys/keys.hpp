// `tandem keys`: what the ends of a run over DDS need to believe each other and to hide from others.
#pragma once

#include <filesystem>

namespace tandem::launch {

// A new secret in a new file that only its owner can read. Error{usage} where there is a file already.
void write_secret(const std::filesystem::path& file);

// A new folder of certificates for DDS Security, valid from now for so many days: an authority (whose key is
// not kept, so that nobody makes more), an identity for all ends of the run, and signed rules that admit that
// identity alone and have everything encrypted. Error{usage} where there is something already, or in a build
// without DDS.
void write_certificates(const std::filesystem::path& folder, int days);

}  // namespace tandem::launch
