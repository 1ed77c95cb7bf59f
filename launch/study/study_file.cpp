#include "launch/study/study_file.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "common/input_file.hpp"
#include "common/scene/document.hpp"
#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/schema_check.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Pointer = json::json_pointer;

const std::map<std::string, std::string>& known_settings() {
  static const std::map<std::string, std::string> known{
      {"scheme", "/coupling/scheme"},
      {"window", "/coupling/window"},
      {"load", "/coupling/load"},
      {"path", "/coupling/path"},
      {"tolerance", "/coupling/iteration/tolerance"},
      {"end_time", "/end_time"},
      {"method", "/mbd/integrator/method"},
      {"rho_inf", "/mbd/integrator/rho_inf"},
      {"mbd_step", "/mbd/integrator/step"},
      {"error_tolerance", "/mbd/integrator/error_tolerance"},
      {"newton_tolerance", "/mbd/integrator/tolerance"},
      {"micro_step", "/dem/micro_step"},
      {"precision", "/dem/precision"},
      {"variant", "/dem/variant"},
      {"contact", "/dem/contact"},
      {"skin", "/dem/skin"},
  };
  return known;
}

class Reader {
 public:
  explicit Reader(const fs::path& path) : path_(path), origin_(path.string()) {}

  Study read() {
    const json document = load();
    Study study;
    study.file = path_;
    study.name = document.at("name");
    study.description = document.value("description", "");
    study.scene = path_.parent_path() / document.at("scene").get<std::string>();
    study.backend = document.value("backend", study.backend);
    study.threads = document.value("threads", study.threads);
    study.repeat = document.value("repeat", study.repeat);
    study.limit = document.value("limit", study.limit);
    study.set = settings(document.value("set", json::array()), "set");
    study.sweep = sweeps(document.at("sweep"));
    study.order_in = document.value("order_in", "");
    if (!study.order_in.empty()) check_order(study);
    if (document.contains("reference")) study.reference = reference(document.at("reference"));
    study.measures = measures(document.at("measures"), study.reference);
    return study;
  }

 private:
  json load() const {
    const std::string text = read_input(path_, {.largest = largest_text, .hint = "give the path of a study"});
    json document = scene::read_document(text, origin_);
    scene::check_schema(json::parse(study_schema()), document, origin_);
    return document;
  }

  [[noreturn]] void fail(const std::string& path, const std::string& problem, const std::string& hint) const {
    scene::fail(origin_, path, problem, hint);
  }

  Pointer pointer(const std::string& name, const std::string& path) const {
    if (const auto known = known_settings().find(name); known != known_settings().end())
      return Pointer(known->second);
    if (name.front() != '/')
      fail(path, "there is no setting '" + shortened(name) + "'",
           suggest_name(name, setting_names(), "settings") +
               "; others are given by a JSON pointer such as /mbd/bodies/0/mass");
    try {
      return Pointer(name);
    } catch (const json::exception&) {
      fail(path, "'" + shortened(name) + "' is no JSON pointer", "~ stands before 0 or 1 only");
    }
  }

  std::vector<Setting> settings(const json& list, const std::string& path) const {
    std::vector<Setting> settings;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string name = list[i].at("of");
      settings.push_back({name, pointer(name, scene::element(path, i) + ".of"), list[i].at("value")});
    }
    return settings;
  }

  std::vector<Sweep> sweeps(const json& list) const {
    std::vector<Sweep> sweeps;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string name = list[i].at("of"), path = scene::element("sweep", i) + ".of";
      const Pointer at = pointer(name, path);
      for (const Sweep& other : sweeps)
        if (other.at == at)
          fail(path, "'" + shortened(name) + "' is swept twice", "put all values into one list");
      sweeps.push_back({name, at, list[i].at("values").get<std::vector<json>>()});
    }
    return sweeps;
  }

  void check_order(const Study& study) const {
    std::vector<std::string> names;
    for (const Sweep& sweep : study.sweep) {
      names.push_back(sweep.name);
      if (sweep.name != study.order_in) continue;
      for (const json& value : sweep.values)
        if (!value.is_number() || !(value > 0))
          fail("order_in", "'" + sweep.name + "' has the value " + value.dump(),
               "an order is observed in a step size: a number > 0");
      return;
    }
    fail("order_in", "'" + shortened(study.order_in) + "' is not swept",
         suggest_name(study.order_in, names, "sweeps"));
  }

  Reference reference(const json& node) const {
    const std::string type = node.at("type");
    if (type == "run") return RunReference{settings(node.at("set"), "reference.set"), node.at("every")};
    if (type == "folder")
      return FolderReference{path_.parent_path() / node.at("folder").get<std::string>(), node.at("every")};
    TableReference table{node.value("source", ""), node.at("times"), {}};
    for (std::size_t i = 1; i < table.times.size(); ++i)
      if (!(table.times[i] > table.times[i - 1]))
        fail(scene::element("reference.times", i),
             scene::text(table.times[i]) + " s does not come after " + scene::text(table.times[i - 1]) + " s",
             "times must increase");
    const json& signals = node.at("signals");
    for (std::size_t i = 0; i < signals.size(); ++i) {
      table.signals.push_back({signals[i].at("of"), signals[i].at("values")});
      if (table.signals[i].values.size() != table.times.size())
        fail(scene::element("reference.signals", i) + ".values",
             std::to_string(table.signals[i].values.size()) + " values for " +
                 std::to_string(table.times.size()) + " times",
             "give one value for each time");
    }
    return table;
  }

  std::vector<Measure> measures(const json& list, const Reference& reference) const {
    std::vector<Measure> measures;
    std::set<std::string> names;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const json& node = list[i];
      const std::string path = scene::element("measures", i);
      Measure measure{node.at("name"),
                      node.at("of"),
                      node.value("error", "largest"),
                      node.value("from", 0.0),
                      node.value("expected", 0.0),
                      node.value("unit", "")};
      if (!names.insert(measure.name).second)
        fail(path + ".name", "'" + measure.name + "' is already the name of a measure", "give another name");
      check_measure(measure, node, path, reference);
      measures.push_back(std::move(measure));
    }
    return measures;
  }

  void check_measure(const Measure& measure, const json& node, const std::string& path,
                     const Reference& reference) const {
    if (measure.of_summary()) {
      if (measure.of.size() > 1)
        fail(path + ".of", "summary.json and other values in one measure", "make a measure of each");
      if (node.contains("error") || node.contains("from"))
        fail(path, "a number of summary.json has no course in time", "leave out error and from");
      return;
    }
    if (node.contains("expected"))
      fail(path + ".expected", "only a number of summary.json has one",
           "signals are compared with the reference");
    if (std::holds_alternative<std::monostate>(reference))
      fail(path, "there is no reference to compare '" + shortened(measure.of.front()) + "' with",
           "add reference");
    const auto* table = std::get_if<TableReference>(&reference);
    if (measure.of_figure() && measure.of.size() > 1)
      fail(path + ".of",
           "the " + measure.error + " is that of one signal, not of " + std::to_string(measure.of.size()),
           "make a measure of each");
    if (!table) return;
    if (measure.of_figure())
      fail(path + ".error", "a table has no " + measure.error + " of the whole signal",
           "use largest, rms or last, or a reference of type run or folder");
    std::vector<std::string> columns;
    for (const auto& signal : table->signals) columns.push_back(signal.column);
    for (const std::string& column : measure.of)
      if (std::find(columns.begin(), columns.end(), column) == columns.end())
        fail(path + ".of", "the table has no signal '" + shortened(column) + "'",
             suggest_name(column, columns, "signals"));
  }

  const fs::path path_;
  const std::string origin_;
};

}  // namespace

std::vector<std::string> setting_names() {
  std::vector<std::string> names;
  for (const auto& [name, pointer] : known_settings()) names.push_back(name);
  return names;
}

Study read_study(const fs::path& path) {
  return Reader(path).read();
}

}  // namespace tandem::launch
