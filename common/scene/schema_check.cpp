#include "common/scene/schema_check.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>
#include <vector>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/schema.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

using nlohmann::json;
using Found = std::optional<Fault>;

const json& built_in() {
  static const json document = json::parse(schema());
  return document;
}

std::string written(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_number_float()) return text(value.get<double>());
  return shortened(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

bool has_type(const json& value, const std::string& type) {
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number_integer();
  return type == value.type_name();
}

std::string with_article(const std::string& type) {
  if (type == "array") return "a list";
  return (type == "object" || type == "integer" ? "an " : "a ") + type;
}

std::vector<std::string> strings(const json& list) {
  return list.get<std::vector<std::string>>();
}

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

// The search for the first fault. `node` is the subschema with its references resolved; `meaning` is the
// description of the nearest key.
class Walk {
 public:
  explicit Walk(const json& schema) : schema_(schema) {}

  Found check(const json& node, const json& value, const std::string& path,
              const std::string& meaning) const {
    const json& rule = resolved(node);
    const std::string here = node.value("description", rule.value("description", meaning));
    if (rule.contains("oneOf")) return check_tagged(rule["oneOf"], value, path, here);
    if (rule.contains("anyOf")) return check_any(rule["anyOf"], value, path, here);
    if (rule.contains("const")) return check_const(rule["const"], value, path, here);
    if (rule.contains("enum")) return check_enum(rule["enum"], value, path, here);
    if (!has_type(value, rule["type"])) {
      const bool is_name = value.is_string() && rule["type"] == "object" && rule.contains("properties") &&
                           rule["properties"].contains("name");
      return wrong(value, path,
                   with_article_of(rule) + (is_name ? ", as {\"name\": " + written(value) + ", ...}" : ""),
                   here);
    }
    if (value.is_object()) return check_object(rule, value, path);
    if (value.is_array()) return check_array(rule, value, path, here);
    if (value.is_string()) return check_string(rule, value, path, here);
    if (value.is_number()) {
      Found fault = check_number(rule, value, path, here);
      // A number that is wrong by its last digits only is shown with them.
      if (fault && !check_number(rule, json::parse(written(value)), path, here))
        fault->problem = "the value is " + exact_text(value.get<double>());
      return fault;
    }
    return {};
  }

 private:
  const json& resolved(const json& node) const {
    constexpr std::size_t hash = 1;  // "#/definitions/x" is the pointer "/definitions/x"
    if (!node.contains("$ref")) return node;
    return schema_.at(json::json_pointer(node["$ref"].get_ref<const std::string&>().substr(hash)));
  }

  static std::string with_article_of(const json& rule) {
    const auto type = rule["type"].get<std::string>();
    return type == "object" ? with_article(type) : rule.value("title", with_article(type));
  }

  static Fault wrong(const json& value, const std::string& path, const std::string& needed,
                     const std::string& meaning) {
    return {path, "the value is " + written(value),
            "give " + needed + (meaning.empty() ? "" : ": " + meaning)};
  }

  // Checks one of several objects that differ in "type".
  Found check_tagged(const json& branches, const json& value, const std::string& path,
                     const std::string& meaning) const {
    if (!value.is_object()) return wrong(value, path, "an object", meaning);
    std::vector<std::string> types;
    for (const json& branch : branches) {
      const json& tag = resolved(branch)["properties"]["type"];
      const std::vector<std::string> own = tag.contains("enum")
                                               ? strings(tag["enum"])
                                               : std::vector<std::string>{tag["const"].get<std::string>()};
      const auto is_named = [&](const std::string& type) { return value["type"] == json(type); };
      if (value.contains("type") && std::any_of(own.begin(), own.end(), is_named))
        return check(branch, value, path, meaning);
      types.insert(types.end(), own.begin(), own.end());
    }
    if (!value.contains("type"))
      return Fault{path, "the key 'type' is missing", suggest_name("", types, "types")};
    return unknown_word(value["type"], joined(path, "type"), types);
  }

  // Checks one of several kinds of value, distinguished by type and length.
  Found check_any(const json& branches, const json& value, const std::string& path,
                  const std::string& meaning) const {
    std::string kinds;
    for (const json& branch : branches) {
      const json& rule = resolved(branch);
      const bool fits_length = !value.is_array() || value.size() == rule.value("minItems", value.size());
      const bool is_word = !rule.contains("const") || rule["const"] == value;
      if (has_type(value, rule["type"]) && fits_length && is_word) return check(branch, value, path, meaning);
      kinds += (kinds.empty() ? "" : " or ") + with_article_of(rule);
    }
    return wrong(value, path, kinds, meaning);
  }

  static Found check_const(const json& only, const json& value, const std::string& path,
                           const std::string& meaning) {
    if (value == only) return {};
    return wrong(value, path, written(only), meaning);
  }

  static Found check_enum(const json& words, const json& value, const std::string& path,
                          const std::string& meaning) {
    if (std::find(words.begin(), words.end(), value) != words.end()) return {};
    if (!value.is_string()) return wrong(value, path, "a string", meaning);
    return unknown_word(value, path, strings(words));
  }

  static Fault unknown_word(const json& value, const std::string& path,
                            const std::vector<std::string>& words) {
    const std::string word = value.is_string() ? value.get<std::string>() : "";
    return {path, "the value is " + written(value), suggest_name(word, words, "values")};
  }

  // Names the kind of object that does not have the key.
  static std::string of_type(const json& value) {
    const auto type = value.find("type");
    return type != value.end() && type->is_string()
               ? " for type '" + shortened(type->get<std::string>()) + "'"
               : "";
  }

  // Unknown keys come first: a missing key is often a consequence of a misspelt one.
  Found check_object(const json& rule, const json& value, const std::string& path) const {
    if (!rule.contains("properties")) return {};  // any object
    const json& properties = rule["properties"];
    for (const auto& item : value.items())
      if (!properties.contains(item.key()))
        return Fault{path, "unknown key '" + shortened(item.key()) + "'" + of_type(value),
                     suggest_name(item.key(), keys_of(properties), "keys")};
    for (const json& key : rule.value("required", json::array()))
      if (!value.contains(key)) {
        const json& missing = properties[key.get<std::string>()];
        const std::string meaning = missing.value("description", "");
        return Fault{path, "the key '" + key.get<std::string>() + "' is missing",
                     "add " + key.get<std::string>() + ": " + meaning};
      }
    for (const auto& item : value.items())
      if (Found fault = check(properties[item.key()], item.value(), joined(path, item.key()), ""))
        return fault;
    return {};
  }

  Found check_array(const json& rule, const json& value, const std::string& path,
                    const std::string& meaning) const {
    const std::size_t least = rule.value("minItems", std::size_t{0}),
                      most = rule.value("maxItems", value.size());
    if (value.size() < least || value.size() > most) {
      const std::string needed = rule.contains("title") ? with_article_of(rule)
                                                        : "at least " + std::to_string(least) +
                                                              (least == 1 ? " element" : " elements");
      return value.empty() ? Fault{path, "the list is empty", "give " + needed + ": " + meaning}
                           : wrong(value, path, needed, meaning);
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (Found fault = check(rule["items"], value[i], element(path, i), meaning)) return fault;
      if (rule.value("uniqueItems", false) &&
          std::find(value.begin(), value.begin() + i, value[i]) != value.begin() + i)
        return Fault{element(path, i), "the value " + written(value[i]) + " is given twice",
                     "keep one of them"};
    }
    return {};
  }

  Found check_string(const json& rule, const json& value, const std::string& path,
                     const std::string& meaning) const {
    const auto& string = value.get_ref<const std::string&>();
    if (string.size() < rule.value("minLength", std::size_t{0})) return wrong(value, path, "a text", meaning);
    if (const auto longest = rule.value("maxLength", string.size()); string.size() > longest)
      return wrong(value, path, "at most " + std::to_string(longest) + " characters", meaning);
    if (rule.contains("pattern") && !std::regex_search(string, pattern(rule["pattern"])))
      return wrong(value, path, "a word of letters, digits, _ and -", meaning);
    return {};
  }

  static Found check_number(const json& rule, const json& value, const std::string& path,
                            const std::string& meaning) {
    const double number = value.get<double>();
    const auto bound = [&](const char* key, const char* sign, bool holds) -> Found {
      if (holds) return {};
      return wrong(value, path, std::string("a number ") + sign + " " + text(rule[key].get<double>()),
                   meaning);
    };
    const auto limit = [&](const char* key) { return rule.value(key, number); };
    if (rule.contains("minimum") && rule.contains("maximum") &&
        !(number >= rule["minimum"] && number <= rule["maximum"]))
      return wrong(value, path,
                   "a number from " + text(rule["minimum"].get<double>()) + " to " +
                       text(rule["maximum"].get<double>()),
                   meaning);
    Found fault = bound("minimum", ">=", number >= limit("minimum"));
    if (!fault) fault = bound("maximum", "<=", number <= limit("maximum"));
    if (!fault && rule.contains("exclusiveMinimum"))
      fault = bound("exclusiveMinimum", ">", number > rule["exclusiveMinimum"]);
    if (!fault && rule.contains("exclusiveMaximum"))
      fault = bound("exclusiveMaximum", "<", number < rule["exclusiveMaximum"]);
    return fault;
  }

  // Compiled once: that takes longer than a search.
  const std::regex& pattern(const std::string& text) const {
    return patterns_.try_emplace(text, text).first->second;
  }

  const json& schema_;
  mutable std::map<std::string, std::regex> patterns_;
};

// valijson's schema can be neither copied nor moved.
std::unique_ptr<valijson::Schema> compiled(const json& schema) {
  auto target = std::make_unique<valijson::Schema>();
  valijson::SchemaParser(valijson::SchemaParser::kDraft7)
      .populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), *target);
  return target;
}

// Compiled once: it takes milliseconds.
const valijson::Schema& compiled_built_in() {
  static const auto schema = compiled(built_in());
  return *schema;
}

bool conforms(const valijson::Schema& schema, const json& document) {
  valijson::Validator validator;
  return validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(document), nullptr);
}

// The walk comes first: it refuses long names before they are matched with a pattern, which uses stack for
// each character.
void check(const json& schema, const valijson::Schema& compiled, const json& document,
           const std::string& origin) {
  if (const auto fault = Walk(schema).check(schema, document, "", ""))
    fail(origin, fault->path, fault->problem, fault->hint);
  if (!conforms(compiled, document))
    throw Error(ErrorCode::internal, "the schema refuses the file, and the walk along it finds no fault",
                origin, "please report this file");
}

}  // namespace

bool conforms(const json& document) {
  return conforms(compiled_built_in(), document);
}

std::optional<Fault> first_fault(const json& document) {
  return Walk(built_in()).check(built_in(), document, "", "");
}

void check_schema(const json& document, const std::string& origin) {
  check(built_in(), compiled_built_in(), document, origin);
}

void check_schema(const json& schema, const json& document, const std::string& origin) {
  check(schema, *compiled(schema), document, origin);
}

}  // namespace tandem::scene
