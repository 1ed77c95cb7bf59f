// The schema itself: as the one source of truth it must be strict and described. The tests
// docs.keys and docs.json compare it with the pages.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/scene/schema.hpp"
#include "common/scene/schema_check.hpp"
#include "tests/unit/common/good_scene.hpp"

namespace tandem::scene {
namespace {

using nlohmann::json;

// Calls `visit(path, key, rule)` for every key that a scene can have.
template <class Visit>
void for_each_key(const json& node, const std::string& path, const Visit& visit) {
  if (node.is_object() && node.contains("properties"))
    for (const auto& item : node["properties"].items()) visit(path, item.key(), item.value());
  if (node.is_structured())
    for (const auto& item : node.items()) for_each_key(item.value(), path + "/" + item.key(), visit);
}

template <class Visit>
void for_each_object(const json& node, const std::string& path, const Visit& visit) {
  if (node.is_object() && node.contains("properties")) visit(path, node);
  if (node.is_structured())
    for (const auto& item : node.items()) for_each_object(item.value(), path + "/" + item.key(), visit);
}

TEST(Schema, EveryKeyIsDescribed) {
  int keys = 0;
  for_each_key(json::parse(schema()), "",
               [&](const std::string& path, const std::string& key, const json& rule) {
                 EXPECT_TRUE(rule.contains("description")) << path << " " << key;
                 ++keys;
               });
  EXPECT_GT(keys, 100);
}

TEST(Schema, EveryNumberHasAUnit) {
  for_each_key(
      json::parse(schema()), "", [&](const std::string& path, const std::string& key, const json& rule) {
        const bool is_number = rule.value("type", "") == "number" || rule.value("type", "") == "integer" ||
                               rule.value("$ref", "").ends_with("/vec3");
        if (!is_number || (path.ends_with("/check") && key == "expected")) return;
        EXPECT_NE(rule["description"].get<std::string>().find('['), std::string::npos) << path << " " << key;
      });
}

TEST(Schema, NoObjectTakesUnknownKeys) {
  for_each_object(json::parse(schema()), "", [](const std::string& path, const json& rule) {
    if (path.ends_with("/solver_options")) return;  // of solvers that tandem does not know
    EXPECT_EQ(rule.value("additionalProperties", json(true)), json(false)) << path;
  });
}

// The search for the first fault and valijson agree: every value of the good scene is replaced in turn by
// values of other kinds, and wherever valijson refuses the document, the search finds a fault.
class Replacer {
 public:
  explicit Replacer(json document) : document_(std::move(document)) {}

  void visit(json& here) {
    for (const json& other :
         {json(nullptr), json(-7), json(0.5), json("word"), json::array(), json({{"type", "box"}})}) {
      const json kept = here;
      here = other;
      const auto fault = first_fault(document_);
      const bool valid = conforms(document_);
      EXPECT_EQ(valid, !fault) << document_.dump() << (fault ? fault->path + ": " + fault->problem : "");
      refused_ += !valid;
      here = kept;
    }
    if (here.is_structured())
      for (auto& part : here) visit(part);
  }

  void run() { visit(document_); }
  int refused() const { return refused_; }

 private:
  json document_;
  int refused_ = 0;
};

TEST(Schema, WalkAndValijsonAgree) {
  Replacer replacer(test::good_scene());
  replacer.run();
  EXPECT_GT(replacer.refused(), 500);
}

}  // namespace
}  // namespace tandem::scene
