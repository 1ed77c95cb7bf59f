#include "coordinator/results/row_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <vector>

#include "common/file_draft.hpp"
#include "common/input_file.hpp"
#include "coordinator/results/disk_error.hpp"

namespace tandem::launch {
namespace {

constexpr std::uint64_t digest_start = 0xcbf29ce484222325u, digest_factor = 0x100000001b3u;  // FNV-1a

}  // namespace

RowFile::RowFile(std::filesystem::path file, std::string_view header)
    : file_(std::move(file)), end_{0, digest_start, 0} {
  descriptor_ = open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) fail_on_disk(file_, "cannot make the file: " + std::string(std::strerror(errno)));
  try {
    append(std::string(header) + '\n');
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

RowFile::~RowFile() {
  close(descriptor_);
}

void RowFile::append(std::string_view lines) {
  if (!write_all(descriptor_, lines)) fail(errno);
  count(lines);
}

void RowFile::count(std::string_view bytes) {
  std::uint64_t digest = end_.digest;
  for (const char c : bytes) digest = (digest ^ static_cast<unsigned char>(c)) * digest_factor;
  end_ = {end_.size + bytes.size(), digest,
          end_.lines + static_cast<std::uint64_t>(std::count(bytes.begin(), bytes.end(), '\n'))};
}

void RowFile::begin_with(const std::filesystem::path& source, const RowMark& mark) {
  if (ftruncate(descriptor_, 0) != 0 || lseek(descriptor_, 0, SEEK_SET) != 0) fail(errno);
  end_ = {0, digest_start, 0};
  if (std::filesystem::exists(source))
    expect_input(source, {.code = ErrorCode::resource,
                          .largest = std::numeric_limits<std::int64_t>::max()});  // read in pieces
  std::ifstream from(source, std::ios::binary);
  std::vector<char> piece(std::size_t{1} << 18);
  while (end_.size < mark.size) {
    const auto wanted =
        static_cast<std::streamsize>(std::min<std::uint64_t>(piece.size(), mark.size - end_.size));
    if (!from.read(piece.data(), wanted)) break;
    append({piece.data(), static_cast<std::size_t>(wanted)});
  }
  if (end_.size != mark.size || end_.digest != mark.digest || end_.lines != mark.lines)
    throw Error(ErrorCode::resource,
                end_.size != mark.size ? "is not there, or shorter than when the checkpoint was written: " +
                                             std::to_string(mark.size) + " bytes belong to it"
                                       : "was changed since the checkpoint was written",
                source.string(), "continue from a checkpoint in the complete folder of its run");
}

void RowFile::flush_to_disk() const {
  if (fdatasync(descriptor_) != 0 && errno != EINVAL)
    fail_on_disk(file_, "cannot be flushed to the disk: " + std::string(std::strerror(errno)));
}

void RowFile::fail(int error) {
  // An incomplete line on the disk is not a row. Where it cannot be cut off, readers ignore it: it has no
  // line break.
  if (ftruncate(descriptor_, static_cast<off_t>(end_.size)) == 0)
    lseek(descriptor_, static_cast<off_t>(end_.size), SEEK_SET);
  fail_on_disk(file_, "cannot write: " + std::string(std::strerror(error)));
}

}  // namespace tandem::launch
