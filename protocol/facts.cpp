#include "protocol/facts.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "common/utf8.hpp"
#include "protocol/violation.hpp"

namespace tandem::protocol {
namespace {

using Json = nlohmann::ordered_json;

enum class Need { optional, nullable };
enum class Range { any, from_zero };

// A fact of common/scene/figures.def.
struct Line {
  const char* key;
  const char* unit;
  Need need;
  Range range;
  const char* user;
  const char* meaning;
};

// Calls visit(line, member) for every fact; `facts` is MbdFacts, DemFacts or SphFacts, or const.
template <class Facts, class Visit>
void each_fact(Facts& facts, Visit visit) {
  const auto see = [&](const Line& line, auto& member) { visit(line, member); };
  using Plain = std::remove_const_t<Facts>;
#define FACT(runs, type, member, key, unit, need, range, user, meaning) \
  see(Line{key, unit, Need::need, Range::range, user, meaning}, facts.member);
  if constexpr (std::is_same_v<Plain, MbdFacts>) {
#define MBD_FACT FACT
#include "common/scene/figures.def"
  } else if constexpr (std::is_same_v<Plain, DemFacts>) {
#define DEM_FACT FACT
#include "common/scene/figures.def"
  } else {
#define SPH_FACT FACT
#include "common/scene/figures.def"
  }
#undef FACT
}

template <class Type>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<Type, fact::Count>) return "count";
  if constexpr (std::is_same_v<Type, fact::Number>) return "number";
  if constexpr (std::is_same_v<Type, fact::Text>) return "text";
  if constexpr (std::is_same_v<Type, fact::Texts>) return "list of texts";
  if constexpr (std::is_same_v<Type, fact::Estimate>) return "number or text";
}

std::string value_text(const Json& value) {
  return printable(shortened(value.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

[[noreturn]] void refuse_not_finite(Role role, const std::string& key, const std::string& value) {
  throw ProtocolError(Violation::not_finite,
                      "the fact \"" + printable(shortened(key)) + "\" is " + value + ", not finite",
                      name(role));
}

// ---- encoding

void to_json(Json& json, const fact::Estimate& estimate) {
  if (estimate.value)
    json = *estimate.value;
  else
    json = estimate.reason;
}

template <class Facts>
std::string encode(Role role, const Facts& facts, const Json& others) {
  Json object = Json::object();
  each_fact(facts, [&]<class Type>(const Line& line, const std::optional<Type>& member) {
    if (others.contains(line.key))
      throw Error(ErrorCode::internal,
                  "the fact \"" + std::string(line.key) + "\" is also among the other facts", name(role));
    if (!member) {
      if (line.need == Need::nullable) object[line.key] = nullptr;
      return;
    }
    Json& value = object[line.key];
    if constexpr (std::is_same_v<Type, fact::Estimate>)
      to_json(value, *member);
    else
      value = *member;
    if (value.is_number_float() && !std::isfinite(value.template get<double>()))
      refuse_not_finite(role, line.key, std::to_string(value.template get<double>()));
  });
  if (others.is_object()) object.update(others);
  return object.dump();
}

// ---- decoding

// False where the value is not of that type.
bool take(const Json& value, fact::Count& to) {
  // A program may have but doubles, in which a count is written as 3.0 or 1e6.
  constexpr double largest = 9007199254740992;  // 2^53, up to which a double is exact
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!(number >= 0 && number <= largest && number == std::floor(number))) return false;
    to = static_cast<fact::Count>(number);
    return true;
  }
  if (!value.is_number_unsigned()) return false;
  to = value.get<fact::Count>();
  return true;
}
bool take(const Json& value, fact::Number& to) {
  if (!value.is_number()) return false;
  to = value.get<double>();
  return true;
}
bool take(const Json& value, fact::Text& to) {
  if (!value.is_string()) return false;
  to = value.get<std::string>();
  return true;
}
bool take(const Json& value, fact::Texts& to) {
  if (!value.is_array() || !std::ranges::all_of(value, [](const Json& item) { return item.is_string(); }))
    return false;
  to = value.get<fact::Texts>();
  return true;
}
bool take(const Json& value, fact::Estimate& to) {
  to = {};
  if (take(value, to.reason)) return true;
  return take(value, to.value.emplace());
}

bool is_negative(fact::Number value) {
  return value < 0;
}
bool is_negative(const fact::Estimate& estimate) {
  return estimate.value && *estimate.value < 0;
}
template <class Type>
bool is_negative(const Type&) {
  return false;
}

std::string with_range(const char* type, const Line& line) {
  std::string text = type;  // "number", "number or text"
  if (line.range == Range::from_zero) text.insert(std::min(text.size(), text.find(' ')), " from 0 on");
  return text;
}
std::string with_unit(const std::string& type, const Line& line) {
  return type + (std::string_view(line.unit) == "-" ? "" : " [" + std::string(line.unit) + "]");
}

// A part of nothing, or one that is larger than the whole.
template <class Type>
void expect_part(Role role, const std::optional<Type>& part, const char* part_key,
                 const std::optional<Type>& whole, const char* whole_key) {
  // Numbers are sums in any order.
  constexpr double rounding = std::is_same_v<Type, fact::Number> ? 1e-9 : 0;
  if (!part || !whole || *part <= *whole) return;
  if (static_cast<double>(*part - *whole) <= rounding * static_cast<double>(*whole)) return;
  throw ProtocolError(Violation::bad_fact,
                      "the fact \"" + std::string(part_key) + "\" is " + Json(*part).dump() + ", and \"" +
                          whole_key + "\", of which it is a part, " + Json(*whole).dump(),
                      name(role), "docs/protocol.md has the meaning of each fact");
}
void expect_possible(const MbdFacts& facts) {
  // One step may be shortened more than once: the rule shortened_steps judges other numbers.
  if (facts.steps == 0u)
    expect_part(Role::mbd, facts.shortened_steps, "mbd_shortened_steps", facts.steps, "mbd_steps");
}
void expect_possible(const DemFacts& facts) {
  expect_part(Role::dem, facts.came_in, "came_in", facts.spheres, "spheres");
  expect_part(Role::dem, facts.went_out, "went_out", facts.spheres, "spheres");
}

void expect_possible(const SphFacts& facts) {
  expect_part(Role::sph, facts.lost, "lost_kg", facts.mass_in_all, "mass_in_all_kg");
}

template <class Facts>
void decode(Role role, const Json& sent, Facts& facts) {
  each_fact(facts, [&]<class Type>(const Line& line, std::optional<Type>& member) {
    const auto found = sent.find(line.key);
    if (found == sent.end()) return;
    member.reset();
    if (found->is_null() && line.need == Need::nullable) return;
    Type value{};
    if (!take(*found, value) || (line.range == Range::from_zero && is_negative(value)))
      throw ProtocolError(
          Violation::bad_fact,
          "the fact \"" + std::string(line.key) + "\" is " + value_text(*found) + ", not a " +
              with_unit(with_range(type_name<Type>(), line), line),
          name(role),
          found->is_null()
              ? "leave the key out where there is no value, and send no number that is not finite"
              : "docs/protocol.md has the type of each fact");
    member = std::move(value);
  });
  expect_possible(facts);
}

// The word of a JSON text that ends at or holds `at`.
std::string word_at(const std::string& text, std::size_t at) {
  constexpr const char* apart = ":,[]{} \t\r\n";
  at = std::min(at, text.size() - 1);
  const std::size_t before = text.find_last_of(apart, at);
  const std::size_t from = before == std::string::npos ? 0 : before + 1;
  return text.substr(from, text.find_first_of(apart, from) - from);
}

Json parse(Role role, const std::string& text) {
  const auto refuse = [&](const std::string& problem) {
    throw ProtocolError(Violation::bad_fact, "sent facts " + problem + ": " + printable(shortened(text)),
                        name(role));
  };
  if (text.size() > largest_facts)
    throw ProtocolError(
        Violation::bad_fact,
        "sent facts of " + std::to_string(text.size()) + " bytes, more than " + std::to_string(largest_facts),
        name(role), "report sums, and write tables to a file of your own");
  // Copying and writing JSON is recursive.
  constexpr int deepest = 64;
  std::size_t values = 0;
  std::string key;  // the last one
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > deepest) refuse("that are nested more than " + std::to_string(deepest) + " deep");
    using Event = Json::parse_event_t;
    const bool is_value = event == Event::value || event == Event::object_end || event == Event::array_end;
    if (is_value && ++values > most_facts)
      throw ProtocolError(Violation::bad_fact,
                          "sent more than " + std::to_string(most_facts) + " facts and elements", name(role),
                          "report sums, and write tables to a file of your own");
    if (event == Event::key) {
      key = value.get<std::string>();
      if (depth == 1 && !is_fact_key(key))
        throw ProtocolError(Violation::bad_fact,
                            "sent a fact with the key \"" + printable_line(shortened(key)) + '"', name(role),
                            fact_key_rule);
    }
    return true;
  };
  Json sent;
  try {
    sent = Json::parse(text, watch);
  } catch (const Json::parse_error& error) {
    // What programs of other languages write for a number that is not finite.
    const std::string word = word_at(text, error.byte > 0 ? error.byte - 1 : 0);
    for (const char* none : {"NaN", "Infinity", "-Infinity", "nan", "inf", "-inf", "-nan"})
      if (word == none) refuse_not_finite(role, key, word);
    refuse("that are no JSON object in UTF-8");
  } catch (const Json::out_of_range&) {
    refuse_not_finite(role, key, "beyond the largest double");
  }
  if (!sent.is_object()) refuse("that are no JSON object in UTF-8");
  return sent;
}

template <class Facts>
std::string rows(const char* role) {
  std::string table;
  Facts facts;
  each_fact(facts, [&]<class Type>(const Line& line, const std::optional<Type>&) {
    table += "| " + std::string(role) + " | `" + line.key + "` | " + with_range(type_name<Type>(), line) +
             (line.need == Need::nullable ? " or null" : "") + " | " + line.unit + " | " + line.meaning +
             " | " + line.user + " |\n";
  });
  return table;
}

}  // namespace

bool is_fact_key(const std::string& key) {
  const auto of_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !key.empty() && key.size() <= 100 && std::ranges::all_of(key, of_word);
}

std::string encode_facts(const MbdFacts& facts, const Json& others) {
  return encode(Role::mbd, facts, others);
}

std::string encode_facts(const DemFacts& facts, const Json& others) {
  return encode(Role::dem, facts, others);
}

std::string encode_facts(const SphFacts& facts, const Json& others) {
  return encode(Role::sph, facts, others);
}

Json decode_facts(Role role, const std::string& text, SolverFacts& facts) {
  if (text.empty()) return Json::object();
  Json sent = parse(role, text);
  switch (role) {
    case Role::mbd:
      decode(role, sent, facts.mbd);
      break;
    case Role::dem:
      decode(role, sent, facts.dem);
      break;
    case Role::sph:
      decode(role, sent, facts.sph);
  }
  return sent;
}

std::string facts_as_markdown() {
  return "| participant | key | type | unit | meaning | who acts upon it "
         "|\n|---|---|---|---|---|---|\n" +
         rows<MbdFacts>("mbd") + rows<DemFacts>("dem") + rows<SphFacts>("sph");
}

}  // namespace tandem::protocol
