// What options of several verbs have in common.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {

// Turns a word into the value that it names. A word that is none of them is refused with the nearest one.
template <class Value>
CLI::Validator one_of(const std::map<std::string, Value>& words) {
  std::vector<std::string> names;
  for (const auto& item : words) names.push_back(item.first);
  return CLI::Validator(
      [words, names](std::string& word) -> std::string {
        const auto found = words.find(word);
        if (found == words.end())
          return fmt::format("there is no '{}' ({})", printable(shortened(word)),
                             suggest_name(word, names, "words"));
        word = std::to_string(static_cast<int>(found->second));
        return {};
      },
      fmt::format("{{{}}}", fmt::join(names, ",")));
}

// "--set mouth=0.08": values of the scene's parameters.
inline void add_set(CLI::App& verb, std::map<std::string, double>& set) {
  verb.add_option_function<std::vector<std::string>>(
          "--set",
          [&set](const std::vector<std::string>& assignments) {
            for (const std::string& text : assignments) {
              const std::size_t equals = text.find('=');
              double value = 0;
              if (equals == std::string::npos || equals == 0 ||
                  !CLI::detail::lexical_cast(text.substr(equals + 1), value) || !std::isfinite(value))
                throw Error(ErrorCode::usage,
                            "'" + printable(shortened(text)) + "' gives no parameter a number", "--set",
                            "write NAME=NUMBER, as in --set mouth=0.08");
              if (!set.emplace(text.substr(0, equals), value).second)
                throw Error(ErrorCode::usage,
                            "'" + printable(shortened(text.substr(0, equals))) + "' is set twice", "--set",
                            "leave one of them");
            }
          },
          "Value of a parameter of the scene, in its unit: NAME=NUMBER; may be given several times")
      ->allow_extra_args(false);
}

// CLI::Range takes "nan", which compares as neither below nor above.
inline CLI::Validator finite_in_range(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
        return fmt::format("'{}' is no number from {} to {}", printable(shortened(text)), low, high);
      },
      fmt::format("FLOAT in [{} - {}]", low, high));
}

// JSON, into which the value goes, has no other numbers.
inline void expect_finite(const std::optional<double>& seconds, const char* option) {
  if (seconds && !std::isfinite(*seconds))
    throw Error(ErrorCode::usage, fmt::format("{} is no time that a run can have", *seconds), option,
                "give a finite number of seconds");
}

// Options that replace the servers of a run.
template <class Options>
void add_servers(CLI::App& verb, Options& options) {
  verb.add_option(
      "--mbd-server", options.mbd_server,
      "Command of a multibody solver that replaces mbd_server (docs/swap.md), with its arguments");
  verb.add_option("--dem-server", options.dem_server, "The same for the particle solver, dem_server");
  verb.add_option("--sph-server", options.sph_server, "The same for the solver of a liquid, sph_server");
  verb.add_flag("--allow-scene-servers", options.allow_scene_servers,
                "Start the programs that the scene names as mbd.server, dem.server and sph.server: only for "
                "scenes that you trust");
}

}  // namespace tandem::launch
