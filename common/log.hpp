// Logging for all programs: spdlog behind two functions, so that format and sinks are chosen in one place.
// Levels: error: the run ends; warn: the user should look; info: one line per phase; debug: one line per
// window.
#pragma once

#include <spdlog/spdlog.h>

#include <string>

namespace tandem::log {

// Logs of this process carry `program` ("tandem", "mbd_server", "dem_server") and go to stderr,
// and to `file` as well where it is given: Error{resource} where that cannot be made. Safe to call again.
void setup(const std::string& program, const std::string& level = "info", const std::string& file = {});
// From now on only warnings and errors go to stderr; the file keeps its level.
void quiet();

using spdlog::debug;
using spdlog::error;
using spdlog::info;
using spdlog::warn;

}  // namespace tandem::log
