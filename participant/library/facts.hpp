// Figures of a solver for summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "participant/include/tandem/participant.h"

struct tandem_facts {
  explicit tandem_facts(std::string role_prefix) : prefix(std::move(role_prefix)) {}
  std::string prefix;  // "mbd_" or "dem_"
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  // Replaces bytes that are not UTF-8.
  std::string text() const {
    return values.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }
};
