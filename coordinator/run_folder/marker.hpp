// The marker of a run's folder: identity of the run, and a lock that is held while the run is in progress.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace tandem::launch {

// A lock on an open file that is released when the process ends for any reason, and that can be tested
// without being taken (F_OFD_SETLK, F_OFD_GETLK of fcntl(2)). It also works between hosts where the file
// system supports locks.
enum class Lock { free, held, unknown };  // unknown: the file system has no locks
// Returns `free` where it was taken.
Lock take_lock(int descriptor);
Lock look_at_lock(int descriptor);

struct Marker {
  std::string scene;  // name of the scene
  uid_t owner = 0;    // of the file
  std::string host;
  std::int64_t pid = 0;
  std::uint64_t started = 0;  // start of the process [clock ticks since the host's boot]
  std::string boot;           // identifies the boot: /proc/sys/kernel/random/boot_id
  bool ended = false;         // the run ended in order
  Lock lock = Lock::unknown;  // at the time of reading
};

// The marker of this process.
Marker own_marker(std::string scene);
std::string to_text(const Marker& marker);

// None where the folder has no marker, or a file of that name that is not regular or not readable for this
// user.
std::optional<Marker> read_marker(const std::filesystem::path& folder);

// Whether the process that wrote the marker is still running, as far as this process can determine: by the
// lock, and on its own host by the process.
enum class Life { lives, gone, unknown };
Life life_of(const Marker& marker);

}  // namespace tandem::launch
