// The judgement as a table for the console, as JSON and as a page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "launch/conform/judge.hpp"

namespace tandem::conform {

// One row: "PASS         free_fall        velocity of ball: (..) m/s, expected (..), tolerance 3e-4".
std::string row(const Result& result);
// All rows and a last line with the counts.
std::string table(const Judgement& judgement);
std::string last_line(const Judgement& judgement);

nlohmann::ordered_json to_json(const Judgement& judgement);
// A page that needs no other file.
std::string page(const Judgement& judgement);

}  // namespace tandem::conform
