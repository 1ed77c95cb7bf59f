// Ends of a run that were refused, for the log and for the error where no other end came. Cyclone's threads
// report here for every message of a stranger; the channel's thread logs it once for each power of two.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace tandem::protocol::dds {

class Strangers {
 public:
  // `who`: the name that the end claims, which is not authenticated.
  void report(const std::string& who, const char* why);
  // Writes to the log what has not been logged yet.
  void log_new(const std::string& run);
  // "dem_server (pid 12 on nodeb): its secret is another"; empty: nobody was refused.
  std::string last() const;
  std::uint64_t count() const;

 private:
  mutable std::mutex mutex_;
  std::string last_;
  std::uint64_t count_ = 0, logged_ = 0;
};

}  // namespace tandem::protocol::dds
