// Ends of a run that were refused, for the log and for the error where no other came. Cyclone's threads
// report here, as often as a stranger speaks; the channel's thread says it, once for each power of two.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace tandem::protocol::dds {

class Strangers {
 public:
  // `who` as it calls itself, which nobody has proved.
  void report(const std::string& who, const char* why);
  // Writes to the log what has not been said yet.
  void tell(const std::string& run);
  // "dem_server (pid 12 on nodeb): its secret is another"; empty: nobody was refused.
  std::string last() const;
  std::uint64_t count() const;

 private:
  mutable std::mutex mutex_;
  std::string last_;
  std::uint64_t count_ = 0, told_ = 0;
};

}  // namespace tandem::protocol::dds
