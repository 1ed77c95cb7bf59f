#include "common/scene/parse.hpp"

#include <algorithm>
#include <initializer_list>

#include "common/scene/document.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/plain_form.hpp"
#include "common/scene/schema_check.hpp"
#include "common/scene/shape_mesh.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

// Reads one of `words`, which are in the order of the enumeration.
template <class Enum>
void read_word(const Node& node, const char* key, std::initializer_list<const char*> words, Enum& target) {
  if (!node.has(key)) return;
  const auto word = node.value().at(key).get<std::string>();
  target = static_cast<Enum>(std::find(words.begin(), words.end(), word) - words.begin());
}

Iteration parse_iteration(const Node& node) {
  Iteration iteration;
  read_word(node, "method", {"constant", "aitken", "iqn_ils"}, iteration.method);
  read_keys(node, iteration);
  return iteration;
}

Coupling parse_coupling(const Node& node) {
  Coupling coupling;
  read_word(node, "scheme", {"parallel", "mbd_first", "dem_first", "linear_implicit", "implicit"},
            coupling.scheme);
  node.read("window", coupling.window);
  read_word(node, "load", {"mean", "linear", "end"}, coupling.load);
  read_word(node, "path", {"linear", "quadratic"}, coupling.path);
  if (node.has("iteration")) coupling.iteration = parse_iteration(node.at("iteration"));
  if (node.has("adaptive")) read_keys(node.at("adaptive"), coupling.adaptive.emplace());
  return coupling;
}

Output parse_output(const Node& node, const Names& bodies) {
  Output output;
  read_keys(node, output);
  node.read("plots", output.plots);
  if (node.has("fields"))
    for (const std::string& field : node.value().at("fields").get<std::vector<std::string>>())
      output.fields.push_back(static_cast<SphereField>(std::ranges::find(sphere_field_names, field) -
                                                       sphere_field_names.begin()));
  node.read("wall_fields", output.wall_fields);
  if (node.has("contacts"))
    for (const std::string& name : node.value().at("contacts").get<std::vector<std::string>>()) {
      const auto index = bodies.index(name);
      if (!index && name != "ground")
        node.fail("contacts", "unknown name '" + shortened(name) + "'",
                  suggest_name(name, bodies.list(), "bodies"));
      output.contacts.push_back(index ? BodyId{*index} : ground);
    }
  if (node.has("camera")) read_keys(node.at("camera"), output.camera.emplace());
  return output;
}

Check parse_check(const Node& node) {
  Check check;
  node.read("name", check.name);
  node.read("of", check.of);
  node.read("reduce", check.reduce);
  read_keys(node, check);
  if (node.value().at("expected").is_object()) {
    const Node other = node.at("expected");
    other.read("of", check.expected_of);
    other.read("times", check.times);
  } else {
    node.read("expected", check.expected);
  }
  node.read("why", check.why);
  return check;
}

}  // namespace

Scene parse(const std::string& text, const std::string& origin) {
  nlohmann::json document = read_document(text, origin);
  check_schema(document, origin);
  const bool was_plain = !to_plain_form(document, origin);
  const Node root(document, "", origin);

  Scene scene;
  root.read("tandem", scene.format);
  root.read("name", scene.name);
  root.read("description", scene.description);
  root.read("gravity", scene.gravity);
  root.read("end_time", scene.end_time);
  if (root.has("coupling")) scene.coupling = parse_coupling(root.at("coupling"));
  if (root.has("mbd")) scene.mbd = parse_mbd(root.at("mbd"), scene.format);
  const auto bodies = scene.mbd ? root.at("mbd").names("bodies") : Names{};
  if (root.has("dem")) scene.dem = parse_dem(root.at("dem"), bodies);
  if (root.has("sph")) scene.sph = parse_sph(root.at("sph"), bodies);
  parse_shapes(root, scene);
  scene.is_plain =
      was_plain && std::none_of(scene.shapes.begin(), scene.shapes.end(), [&](const Shape& shape) {
        if (shape.use == ShapeUse::contact) return scene.mbd->bodies[shape.body.value].from_shapes;
        return shape.is_of_body || is_made_of_facets(shape.geometry);
      });
  if (root.has("output"))
    scene.output = parse_output(root.at("output"), scene.mbd ? root.at("mbd").names("bodies") : Names{});
  root.names("checks");
  for (const Node& check : root.elements("checks")) scene.checks.push_back(parse_check(check));
  return scene;
}

}  // namespace tandem::scene
