// The marker of a run's folder: who runs there, and a lock that says whether the run goes on.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace tandem::launch {

// A lock on an open file that ends with the process, however that ends, and that can be looked at without
// being taken (F_OFD_SETLK, F_OFD_GETLK of fcntl(2)). It also holds between hosts where the file system has
// locks.
enum class Lock { free, held, unknown };  // unknown: the file system has no locks
// `free` where it was taken.
Lock take_lock(int descriptor);
Lock look_at_lock(int descriptor);

struct Marker {
  std::string scene;  // its name
  uid_t owner = 0;    // of the file
  std::string host;
  std::int64_t pid = 0;
  std::uint64_t started = 0;  // of the process [clock ticks since the host's boot]
  std::string boot;           // which boot: /proc/sys/kernel/random/boot_id
  bool ended = false;         // the run ended in order
  Lock lock = Lock::unknown;  // as seen now
};

// Of this process.
Marker own_marker(std::string scene);
std::string to_text(const Marker& marker);

// None where the folder has no marker, or one that is not a regular file or not ours to read as such.
std::optional<Marker> read_marker(const std::filesystem::path& folder);

// Whether the process that wrote the marker still runs, as far as it can be known from here: by the lock, and
// on its own host by the process.
enum class Life { lives, gone, unknown };
Life life_of(const Marker& marker);

}  // namespace tandem::launch
