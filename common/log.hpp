// Logging for all programs: spdlog behind a few functions, so that format and sinks are chosen in one place.
// Levels: error: the run ends; warn: the user should check; info: one line per phase; debug: one line per
// window.
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace tandem::log {

// Log lines of this process have the name `program` ("tandem", "mbd_server", "dem_server") and go to stderr,
// and to `file` as well where it is given. Throws Error{resource} where the file cannot be created. May be
// called again.
void setup(const std::string& program, const std::string& level = "info", const std::string& file = {});
// From now on only warnings and errors go to stderr; the file keeps its level.
void quiet();

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

}  // namespace tandem::log
