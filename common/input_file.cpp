#include "common/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/utf8.hpp"

namespace tandem {
namespace {

// Names of files may be as long as a path, 4096 bytes; messages show this much of one.
constexpr std::size_t longest_name = 300;

[[noreturn]] void refuse(const std::filesystem::path& file, const InputFile& input,
                         const std::string& problem, const std::string& hint) {
  throw Error(input.code, problem, shortened(file.string(), longest_name), hint);
}

[[noreturn]] void refuse_size(const std::filesystem::path& file, const InputFile& input) {
  const bool small = input.largest < 1 << 20;
  refuse(file, input,
         fmt::format("has more than {} {}, the most that is read of such a file",
                     small ? input.largest : input.largest >> 20, small ? "bytes" : "MiB"),
         "give a smaller file");
}

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "is a folder";
  if (S_ISFIFO(mode)) return "is a pipe";
  if (S_ISSOCK(mode)) return "is a socket";
  return "is a device";
}

// An open plain file of at most the largest size.
class Opened {
 public:
  // Non-blocking, because opening a pipe would wait for somebody who writes to it.
  Opened(const std::filesystem::path& file, const InputFile& input)
      : descriptor_(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
    struct stat status {};
    // A socket cannot be opened, and some devices that are not there neither: their kind is the reason.
    if (descriptor_ < 0) {
      const int error = errno;
      if (stat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))
        refuse(file, input, kind_of(status.st_mode), "give the path of a file");
      refuse(file, input,
             error == ENOENT ? "does not exist" : fmt::format("cannot be read: {}", std::strerror(error)),
             input.hint);
    }
    const int failure = fstat(descriptor_, &status) == 0 ? 0 : errno;
    const bool open_to_others = input.secret != nullptr && (status.st_mode & 077) != 0;
    // Root can read those as well.
    const bool of_another = input.secret != nullptr && status.st_uid != geteuid();
    size_ = static_cast<std::uint64_t>(status.st_size);
    if (failure == 0 && S_ISREG(status.st_mode) && size_ <= input.largest && !open_to_others && !of_another)
      return;
    close(descriptor_);
    if (failure != 0)
      refuse(file, input, fmt::format("cannot be read: {}", std::strerror(failure)), input.hint);
    if (!S_ISREG(status.st_mode))
      refuse(file, input, kind_of(status.st_mode),
             S_ISFIFO(status.st_mode) ? "write what comes through it to a file, and give that"
                                      : "give the path of a file");
    if (of_another)
      refuse(file, input,
             fmt::format("this {} belongs to another user (uid {})", input.secret, status.st_uid),
             "make one of your own");
    if (open_to_others)
      refuse(file, input, fmt::format("other users may read or write this {}", input.secret),
             "chmod 600 it, and make a new one if they did");
    refuse_size(file, input);
  }
  ~Opened() { close(descriptor_); }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;

  int get() const { return descriptor_; }
  std::uint64_t size() const { return size_; }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace

std::string read_input(const std::filesystem::path& file, const InputFile& input) {
  const Opened opened(file, input);
  // One byte more than the file has, to see its end; files of /proc have more than their size says.
  std::string text(opened.size() + 1, '\0');
  std::size_t size = 0;
  for (;;) {
    if (size == text.size()) text.resize(size + std::max<std::size_t>(size, 4096));
    const ssize_t n = read(opened.get(), text.data() + size, text.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) refuse(file, input, fmt::format("cannot be read: {}", std::strerror(errno)), input.hint);
    if (n == 0) break;
    size += static_cast<std::size_t>(n);
    if (size > input.largest) refuse_size(file, input);
  }
  text.resize(size);
  return text;
}

void expect_input(const std::filesystem::path& file, const InputFile& input) {
  const Opened opened(file, input);
}

}  // namespace tandem
