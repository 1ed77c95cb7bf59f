#include "protocol/dds/certificates.hpp"

#include <dds/dds.h>
#include <dlfcn.h>

#include <filesystem>

#include "common/error.hpp"
#include "common/input_file.hpp"

namespace tandem::protocol::dds {
namespace {

namespace fs = std::filesystem;

// Cyclone opens its plug-ins by name at run time. They are in the folder of the library for our own build, or
// in Debian's folder for them.
fs::path plug_in(const char* name) {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&dds_create_domain), &library) == 0)
    throw Error(ErrorCode::resource, "the library of Cyclone DDS cannot be found", "dds");
  const std::string file = std::string("libdds_security_") + name + ".so";
  const fs::path library_folder = fs::path(library.dli_fname).parent_path();
  std::error_code ignored;
  for (const fs::path& path : {library_folder / file, library_folder / "libddsc0debian" / file})
    if (fs::exists(path, ignored)) return path;
  throw Error(ErrorCode::resource, "this installation has no plug-in " + file, library_folder.string(),
              "Debian has it in libddsc0debian; a Cyclone DDS that was built without security has none");
}

std::string checked_file(const fs::path& folder, const char* name) {
  const fs::path path = fs::absolute(folder / name);
  const bool key = name == std::string(certificate_files::key);
  expect_input(path, {.code = ErrorCode::usage,
                      .largest = std::uint64_t{1} << 20,  // they have some kilobytes
                      .hint = "make the folder with: tandem keys --certificates DIR",
                      .secret = key ? "key" : nullptr});
  return "file:" + path.string();
}

}  // namespace

void use_certificates(dds_qos* participant, const std::string& folder) {
  const auto set = [&](const std::string& name, const std::string& value) {
    dds_qset_prop(participant, ("dds.sec." + name).c_str(), value.c_str());
  };
  const auto load = [&](const std::string& part, const char* name, const std::string& function) {
    set(part + ".library.path", plug_in(name));
    set(part + ".library.init", "init_" + function);
    set(part + ".library.finalize", "finalize_" + function);
  };
  load("auth", "auth", "authentication");
  load("access", "ac", "access_control");
  load("crypto", "crypto", "crypto");
  set("auth.identity_ca", checked_file(folder, certificate_files::authority));
  set("auth.identity_certificate", checked_file(folder, certificate_files::identity));
  set("auth.private_key", checked_file(folder, certificate_files::key));
  set("access.permissions_ca", checked_file(folder, certificate_files::authority));
  set("access.governance", checked_file(folder, certificate_files::governance));
  set("access.permissions", checked_file(folder, certificate_files::permissions));
}

}  // namespace tandem::protocol::dds
