#include "common/scene/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/scene/document.hpp"
#include "common/scene/expression.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/material_values.hpp"
#include "common/scene/nearest_name.hpp"

namespace tandem::scene {
namespace parameters {
namespace {

using json = nlohmann::ordered_json;

constexpr double degree = std::numbers::pi / 180;

bool is_expression(const json& value) {
  return value.is_string() && value.get_ref<const std::string&>().starts_with('=');
}

// Units that parameters may have; only deg is converted.
const std::vector<std::string>& units() {
  static const std::vector<std::string> all{
      "deg", "rad",   "m",   "m2",    "m3", "kg", "s",  "1/s",  "m/s",   "m/s2", "m3/s", "rad/s", "N",
      "N/m", "N s/m", "N m", "kg m2", "J",  "W",  "Pa", "Pa s", "kg/m3", "kg/s", "K",    "-"};
  return all;
}

class Parameters {
 public:
  Parameters(const json& given, const std::map<std::string, double>& set, const std::string& origin)
      : given_(given), set_(set), origin_(origin) {
    if (!given.is_object()) fail(origin, "parameters", "it is no object", R"(give {"name": value, ...})");
    for (const auto& [name, value] : given.items()) names_.push_back(name);
    std::ranges::sort(names_);
    for (const std::string& name : names_) check_name(name);
    for (const auto& [name, value] : set)
      if (!given.contains(name))
        throw Error(ErrorCode::usage, "the scene has no parameter '" + name + "'", origin + ": --set",
                    suggest_name(name, names_, "parameters"));
  }

  std::vector<Parameter> all() {
    std::vector<Parameter> values;
    for (const std::string& name : names_) {
      const std::string unit = this->unit(name);
      const Quantity q = value_of(name);
      const json& given = given_[name].is_object() ? given_[name]["value"] : given_[name];
      const auto set = set_.find(name);
      // A number is said as it was given, without the rounding of degrees.
      const double value = set != set_.end()   ? set->second
                           : given.is_number() ? given.get<double>()
                           : unit == "deg"     ? q.value / degree
                                               : q.value;
      values.push_back({name, value, unit.empty() && q.angle == 1 ? "rad" : unit});
    }
    return values;
  }
  // Of an expression at `path` [rad, where it is an angle].
  Quantity evaluate(const std::string& expression, const std::string& path) {
    try {
      return scene::evaluate(std::string_view(expression).substr(1), [&](const std::string& name) {
        if (!given_.contains(name))
          throw ExpressionError("unknown name '" + name + "': " + suggest_name(name, names_, "parameters"));
        return value_of(name);
      });
    } catch (const ExpressionError& error) {
      fail(origin_, path, "\"" + expression + "\": " + error.what(),
           "see 'Parameters' in docs/scene_format.md");
    }
  }

 private:
  void check_name(const std::string& name) const {
    const std::string path = "parameters." + name;
    const auto is_letter = [](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    };
    const auto is_part = [&](char c) {
      return is_letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
    };
    if (name.empty() || name.size() > 100 || !is_letter(name[0]) || !std::ranges::all_of(name, is_part))
      fail(origin_, path, "no name that expressions can use",
           "take letters, digits and _, at most 100, with a letter first");
    if (std::ranges::find(reserved_names(), name) != reserved_names().end())
      fail(origin_, path, "expressions have '" + name + "' of their own", "take another name");
    const json& value = given_[name];
    if (value.is_number() || is_expression(value)) return;
    if (!value.is_object() || !value.contains("value"))
      fail(origin_, path, "no value", R"(give a number, an expression, or {"value": ..., "unit": ...})");
    const std::vector<std::string> keys{"value", "unit", "min", "max"};
    for (const auto& [key, inner] : value.items()) {
      const std::string at = path + "." + key;
      if (std::ranges::find(keys, key) == keys.end())
        fail(origin_, at, "unknown key", suggest_name(key, keys, "keys"));
      if (key == "unit") {
        if (!inner.is_string() || std::ranges::find(units(), inner.get<std::string>()) == units().end())
          fail(origin_, at, inner.dump() + " is no unit of parameters",
               fmt::format("values are in SI or in degrees: {}", fmt::join(units(), ", ")));
      } else if (!inner.is_number() && !is_expression(inner)) {
        fail(origin_, at, "no number", "give a number or an expression");
      }
    }
  }

  std::string unit(const std::string& name) const {
    return given_[name].is_object() ? given_[name].value("unit", std::string{}) : std::string{};
  }
  // A number is in the unit of its parameter.
  Quantity in_unit(const json& value, const std::string& unit, const std::string& path) {
    Quantity q =
        is_expression(value) ? evaluate(value.get<std::string>(), path) : Quantity{value.get<double>(), 0};
    const bool is_angle = unit == "deg" || unit == "rad";
    if (is_angle && q.angle == 0) q = {unit == "deg" ? q.value * degree : q.value, 1};
    if (!unit.empty() && q.angle != (is_angle ? 1 : 0))
      fail(origin_, path, "an angle, and the unit is '" + unit + "'",
           "give the unit deg or rad, or divide by deg");
    return q;
  }
  Quantity value_of(const std::string& name) {
    if (const auto known = known_.find(name); known != known_.end()) return known->second;
    if (std::ranges::find(pending_, name) != pending_.end()) {
      pending_.push_back(name);
      fail(origin_, "parameters." + pending_.front(), fmt::format("a cycle: {}", fmt::join(pending_, " -> ")),
           "give one of them as a number");
    }
    pending_.push_back(name);
    const json& given = given_[name];
    const std::string path = "parameters." + name, of = unit(name);
    const auto set = set_.find(name);
    const json value = set != set_.end() ? json(set->second) : given.is_object() ? given["value"] : given;
    const Quantity q = in_unit(value, of, path);
    for (const char* bound : {"min", "max"}) {
      if (!given.is_object() || !given.contains(bound)) continue;
      const double limit = in_unit(given[bound], of, path + "." + bound).value;
      if (bound[1] == 'i' ? q.value >= limit : q.value <= limit) continue;
      const double scale = of == "deg" ? degree : 1;
      const json& asked = given[bound];
      fail(origin_, path,
           fmt::format("{:.10g} is {} '{}', {}{:.10g}", q.value / scale, bound[1] == 'i' ? "below" : "above",
                       bound, asked.is_string() ? asked.dump() + ", which is " : "", limit / scale),
           "give a value within the limits, or change them");
    }
    pending_.pop_back();
    known_[name] = q;
    return q;
  }

  const json& given_;
  const std::map<std::string, double>& set_;
  const std::string& origin_;
  std::vector<std::string> names_;
  std::vector<std::string> pending_;  // of which the value is being computed
  std::map<std::string, Quantity> known_;
};

// Replaces the expressions in a value that belongs to `key`.
void replace(json& value, const std::string& key, const std::string& path, Parameters& parameters,
             const std::string& origin) {
  if (value.is_object()) {
    for (auto& [name, inner] : value.items())
      // These are another program's.
      if (name != "solver_options")
        replace(inner, name, path.empty() ? name : path + "." + name, parameters, origin);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      replace(value[i], key, element(path, i), parameters, origin);
  } else if (is_expression(value)) {
    const Quantity q = parameters.evaluate(value.get<std::string>(), path);
    if (q.angle != 0 && q.angle != 1)
      fail(origin, path, "the result is a power of an angle",
           "divide by deg or rad where a number is wanted");
    value = key.ends_with("_deg") && q.angle == 1 ? q.value / degree : q.value;
    // A whole number may be a count.
    if (const double v = value.get<double>(); v == std::round(v) && std::fabs(v) < 1e15)
      value = static_cast<std::int64_t>(v);
  }
}

}  // namespace
}  // namespace parameters

std::vector<Parameter> put_in_parameters(std::string& text, const std::map<std::string, double>& set,
                                         const std::string& origin) {
  const nlohmann::json checked = read_document(text, origin);
  expect_known_materials(checked, origin);
  const bool any = checked.is_object() && checked.contains("parameters");
  const bool has_numbers = any || !set.empty() || text.find("\"=") != std::string::npos;
  if (!has_numbers && !may_use_library(text)) return {};
  parameters::json document = parameters::json::parse(text);
  if (!document.is_object()) return {};
  if (!has_numbers) {
    std::vector<Parameter> figures = put_in_materials(document, origin);
    if (!figures.empty()) text = document.dump(2);
    return figures;
  }
  const parameters::json given = any ? document["parameters"] : parameters::json::object();
  document.erase("parameters");
  parameters::Parameters all(given, set, origin);
  std::vector<Parameter> values = all.all();
  parameters::replace(document, "", "", all, origin);
  const std::vector<Parameter> figures = put_in_materials(document, origin);
  values.insert(values.end(), figures.begin(), figures.end());
  text = document.dump(2);
  return values;
}

}  // namespace tandem::scene
