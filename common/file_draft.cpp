#include "common/file_draft.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "common/error.hpp"

namespace tandem {

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

FileDraft::FileDraft(std::filesystem::path file) : file_(std::move(file)), draft_(file_) {
  draft_ += ".new";
  descriptor_ = open(draft_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) fail(errno);
}

FileDraft::~FileDraft() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(draft_.c_str());
}

void FileDraft::append(std::string_view bytes) {
  if (!write_all(descriptor_, bytes)) fail(errno);
}

void FileDraft::append_from(const std::filesystem::path& source, std::uint64_t size) {
  const int from = open(source.c_str(), O_RDONLY | O_CLOEXEC);
  int error = from < 0 ? errno : 0;
  std::vector<char> piece(std::size_t{1} << 16);
  while (size > 0 && error == 0) {
    const ssize_t count = read(from, piece.data(), std::min<std::uint64_t>(piece.size(), size));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 || !write_all(descriptor_, {piece.data(), static_cast<std::size_t>(count)})) error = errno;
    if (count == 0) error = EIO;  // it has become shorter
    size -= static_cast<std::uint64_t>(std::max<ssize_t>(count, 0));
  }
  if (from >= 0) close(from);
  if (error != 0) fail(error);
}

void FileDraft::commit(Durability durability) {
  if (durability == Durability::power && fsync(descriptor_) != 0) fail(errno);
  // Some file systems report a full disk only here. The descriptor is closed in any case.
  if (close(std::exchange(descriptor_, -1)) != 0 || rename(draft_.c_str(), file_.c_str()) != 0) {
    const int error = errno;
    unlink(draft_.c_str());
    fail(error);
  }
  if (durability == Durability::program) return;
  const std::filesystem::path folder = file_.parent_path().empty() ? "." : file_.parent_path();
  const int names = open(folder.c_str(), O_RDONLY | O_CLOEXEC);
  // Some file systems make the names in folders durable by themselves, and return EINVAL.
  const int error = names < 0 || (fsync(names) != 0 && errno != EINVAL) ? errno : 0;
  if (names >= 0) close(names);
  if (error != 0) fail(error);
}

void FileDraft::fail(int error) const {
  throw Error(ErrorCode::resource, "cannot be written: " + std::string(std::strerror(error)), file_.string(),
              "is the folder there and writable, and is there space left on the disk?");
}

void replace_file(const std::filesystem::path& file, std::string_view contents, Durability durability) {
  FileDraft draft(file);
  draft.append(contents);
  draft.commit(durability);
}

}  // namespace tandem
