#include "coordinator/run_folder/marker.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "common/utf8.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/verdict/status.hpp"

namespace tandem::launch {
namespace {

constexpr const char* format = "tandem run folder";
constexpr int version = 1;
constexpr std::size_t longest = 1 << 16;  // of a marker [bytes]

std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

struct flock whole_file() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

std::string text_of(int descriptor) {
  std::string text(longest, '\0');
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

}  // namespace

Lock take_lock(int descriptor) {
  struct flock lock = whole_file();
  if (fcntl(descriptor, F_OFD_SETLK, &lock) == 0) return Lock::free;
  return errno == EAGAIN || errno == EACCES ? Lock::held : Lock::unknown;
}

Lock look_at_lock(int descriptor) {
  struct flock lock = whole_file();
  if (fcntl(descriptor, F_OFD_GETLK, &lock) != 0) return Lock::unknown;
  return lock.l_type == F_UNLCK ? Lock::free : Lock::held;
}

Marker own_marker(std::string scene) {
  const nlohmann::ordered_json process = this_process();
  Marker marker;
  marker.scene = std::move(scene);
  marker.owner = getuid();
  marker.host = process["host"];
  marker.pid = process["pid"];
  marker.started = process["started"];
  marker.boot = boot_id();
  return marker;
}

std::string to_text(const Marker& marker) {
  const nlohmann::ordered_json json{{"format", format},
                                    {"version", version},
                                    {"scene", printable(marker.scene)},
                                    {"owner", marker.owner},
                                    {"host", marker.host},
                                    {"pid", marker.pid},
                                    {"started", marker.started},
                                    {"boot", marker.boot},
                                    // both words are equally long: the
                                    // second replaces the first in place
                                    {"state", marker.ended ? "ended  " : "running"}};
  return json.dump(2) + '\n';
}

std::optional<Marker> read_marker(const std::filesystem::path& folder) {
  const int descriptor = open((folder / marker_name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return {};
  std::optional<Marker> marker;
  struct stat facts {};
  if (fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode)) {
    // A run that died before it wrote its marker has left an empty one.
    if (facts.st_size == 0) marker.emplace().lock = look_at_lock(descriptor);
    const auto json = nlohmann::json::parse(text_of(descriptor), nullptr, false);
    if (json.is_object() && json.value("/format"_json_pointer, nlohmann::json()) == format) {
      try {
        marker.emplace();
        marker->scene = json.value("scene", "");
        marker->host = json.value("host", "");
        marker->pid = json.value("pid", std::int64_t{0});
        marker->started = json.value("started", std::uint64_t{0});
        marker->boot = json.value("boot", "");
        marker->ended = json.value("state", "").starts_with("ended");
        marker->lock = look_at_lock(descriptor);
      } catch (const nlohmann::json::exception&) {
        marker.reset();
      }
    }
    if (marker) marker->owner = facts.st_uid;
  }
  close(descriptor);
  return marker;
}

Life life_of(const Marker& marker) {
  if (marker.lock == Lock::held) return Life::lives;
  // For a run on another host a free lock means nothing where the file system keeps locks per host.
  const Marker own = own_marker({});
  if (marker.host != own.host) return marker.lock == Lock::free ? Life::gone : Life::unknown;
  if (marker.boot != own.boot) return Life::gone;
  if (marker.lock == Lock::free) return Life::gone;
  return process_start(marker.pid) == marker.started ? Life::lives : Life::gone;
}

}  // namespace tandem::launch
