// Signals that stand for an error of one stream.
#pragma once

#include <csignal>

namespace tandem {

// A closed pipe (SIGPIPE) and a file beyond the limit of its size (SIGXFSZ) would end the program; from now
// on the call that writes fails instead, with EPIPE or EFBIG. What this process starts inherits that.
inline void take_stream_signals_as_errors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace tandem
