// Signals that stand for an error of one stream.
#pragma once

#include <csignal>

namespace tandem {

// A closed pipe (SIGPIPE) and a file beyond its size limit (SIGXFSZ) would end the program; from now on the
// writing call fails instead, with EPIPE or EFBIG. Child processes inherit that.
inline void take_stream_signals_as_errors() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace tandem
