#include "launch/keys/keys.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/error.hpp"
#include "launch/keys/private_file.hpp"
#include "protocol/secret.hpp"

namespace tandem::launch {

void write_private_file(const std::filesystem::path& path, const std::string& text) {
  const protocol::Fd file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file)
    throw Error(errno == EEXIST ? ErrorCode::usage : ErrorCode::resource,
                errno == EEXIST ? "is there already, and is not replaced"
                                : std::string("cannot be written: ") + std::strerror(errno),
                path.string(), "give another name");
  if (write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      fsync(file.get()) != 0)
    throw Error(ErrorCode::resource, std::string("cannot be written: ") + std::strerror(errno),
                path.string());
}

void write_secret(const std::filesystem::path& file) {
  write_private_file(file, protocol::make_secret() + "\n");
}

}  // namespace tandem::launch
