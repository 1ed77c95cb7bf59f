// Figures of a solver for summary.json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "participant/include/tandem/participant.h"
#include "protocol/facts.hpp"
#include "protocol/messages.hpp"

struct tandem_facts {
  explicit tandem_facts(tandem::protocol::Role role)
      : prefix(role == tandem::protocol::Role::sph ? "" : std::string(tandem::protocol::word_of(role)) + "_"),
        server(tandem::protocol::name(role)) {}
  std::string prefix;  // "mbd_" or "dem_"; none for a liquid
  nlohmann::ordered_json values = nlohmann::ordered_json::object();
  std::string server;         // for messages
  std::string problem, hint;  // the first one; the message is not sent
  tandem::ErrorCode code{};

  void set(const std::string& key, nlohmann::ordered_json value) {
    if (!tandem::protocol::is_fact_key(key))
      refuse("a fact has the key \"" + tandem::printable_line(tandem::shortened(key)) + "\"; " +
             tandem::protocol::fact_key_rule);
    else if (values.size() >= tandem::protocol::most_facts)
      refuse("there are more than " + std::to_string(tandem::protocol::most_facts) + " facts");
    else
      values[prefix + key] = std::move(value);
  }
  void refuse(const std::string& sentence,
              const std::string& remedy = "report few figures, and write tables to a file of your own",
              tandem::ErrorCode why = tandem::ErrorCode::internal) {
    if (problem.empty()) problem = sentence, hint = remedy, code = why;
  }
  // Replaces bytes that are not UTF-8. Throws Error where the facts are refused.
  std::string text() const {
    if (!problem.empty()) throw tandem::Error(code, problem, server, hint);
    return values.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  }
};
