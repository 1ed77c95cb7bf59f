// What Cyclone DDS itself has to say: its lines go to our log, and no more of them than somebody can read.
// Anybody on the network can have it write a line with each packet that he sends.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace tandem::protocol::dds {

// At most `most` lines in each span of time.
class LineLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr unsigned most = 10;
  static constexpr std::chrono::seconds span{10};

  enum class Fate { written, last_of_span, left_out };
  Fate judge(Time now);
  // Lines left out since this was called last.
  std::uint64_t take_left_out();

 private:
  Time begin_{};
  unsigned written_ = 0;  // since begin_
  std::uint64_t left_out_ = 0;
};

// From now on the lines of Cyclone DDS go to our log. May be called again.
void take_cyclone_lines();

// Why Cyclone DDS last refused the certificate of another end; empty where it refused none.
std::string refused_certificate();

}  // namespace tandem::protocol::dds
