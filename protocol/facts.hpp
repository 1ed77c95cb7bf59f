// Facts that a solver reports in `configured` and `report`: JSON text on the wire, one object. Those that the
// coordinator acts upon are declared in common/scene/figures.def, and typed on both sides; all go to
// summary.json.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace tandem::protocol {

namespace fact {
using Count = std::uint64_t;
using Number = double;  // finite
using Text = std::string;
using Texts = std::vector<std::string>;
struct Estimate {
  std::optional<double> value;  // finite
  std::string reason;           // a sentence that says why there is no value; empty where there is one
};
}  // namespace fact

// One member per fact of common/scene/figures.def; none where the solver has not reported it.
#define FACT(runs, type, member, ...) std::optional<fact::type> member;
struct MbdFacts {
#define MBD_FACT FACT
#include "common/scene/figures.def"
};
struct DemFacts {
#define DEM_FACT FACT
#include "common/scene/figures.def"
};
struct SphFacts {
#define SPH_FACT FACT
#include "common/scene/figures.def"
};
#undef FACT
struct SolverFacts {
  MbdFacts mbd;
  DemFacts dem;
  SphFacts sph;
};

// The text of a message, with `others`: facts that nobody acts upon. Throws ProtocolError{not_finite} where
// a number is not finite, and Error{internal} where `others` has the key of such a fact.
std::string encode_facts(const MbdFacts& facts, const nlohmann::ordered_json& others);
std::string encode_facts(const DemFacts& facts, const nlohmann::ordered_json& others);
std::string encode_facts(const SphFacts& facts, const nlohmann::ordered_json& others);

// Limits of the facts of a solver in one message, with the elements of its lists and objects [bytes], [-].
inline constexpr std::size_t largest_facts = std::size_t{4} << 20, most_facts = 20'000;
// Keys are words, so that a check can name them: summary.KEY.
bool is_fact_key(const std::string& key);
inline constexpr const char* fact_key_rule = "a key is 1 to 100 letters, digits, '_' and '-'";

// Replaces what `facts` has of this solver by what the text has, and returns all of the text. An empty text
// is an object without facts. Throws ProtocolError, with the solver, key and value: `not_finite`, or
// `bad_fact` where a value is not of the type of its fact, is negative where that is impossible, or a part of
// less, where the text is not a JSON object in UTF-8,
// where it is nested more than 64 deep or beyond the limits above, or where a key is no word.
nlohmann::ordered_json decode_facts(Role role, const std::string& text, SolverFacts& facts);

// The table of docs/protocol.md.
std::string facts_as_markdown();

}  // namespace tandem::protocol
