#include "common/scene/parse.hpp"

#include "common/scene/document.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/schema_check.hpp"

namespace tandem::scene {

namespace {

Coupling parse_coupling(const Node& node) {
  Coupling coupling;
  if (node.has("scheme")) {
    const auto scheme = node.value().at("scheme").get<std::string>();
    coupling.scheme = scheme == "parallel"    ? Scheme::parallel
                      : scheme == "mbd_first" ? Scheme::mbd_first
                                              : Scheme::dem_first;
  }
  node.read("window", coupling.window);
  return coupling;
}

Output parse_output(const Node& node) {
  Output output;
  node.read("frame_interval", output.frame_interval);
  if (node.has("camera")) {
    const Node camera = node.at("camera");
    output.camera.emplace();
    camera.read("eye", output.camera->eye);
    camera.read("target", output.camera->target);
    camera.read("up", output.camera->up);
    camera.read("field_of_view", output.camera->field_of_view);
  }
  return output;
}

Check parse_check(const Node& node) {
  Check check;
  node.read("name", check.name);
  node.read("of", check.of);
  node.read("reduce", check.reduce);
  node.read("from", check.from);
  node.read("to", check.to);
  node.read("expected", check.expected);
  node.read("tolerance", check.tolerance);
  node.read("absolute", check.absolute);
  node.read("why", check.why);
  return check;
}

}  // namespace

Scene parse(const std::string& text, const std::string& origin) {
  const nlohmann::json document = read_document(text, origin);
  check_schema(document, origin);
  const Node root(document, "", origin);

  Scene scene;
  root.read("tandem", scene.format);
  root.read("name", scene.name);
  root.read("description", scene.description);
  root.read("gravity", scene.gravity);
  root.read("end_time", scene.end_time);
  if (root.has("coupling")) scene.coupling = parse_coupling(root.at("coupling"));
  if (root.has("mbd")) scene.mbd = parse_mbd(root.at("mbd"));
  if (root.has("dem")) {
    const auto bodies = scene.mbd ? root.at("mbd").names("bodies") : std::vector<std::string>{};
    scene.dem = parse_dem(root.at("dem"), bodies);
  }
  if (root.has("output")) scene.output = parse_output(root.at("output"));
  root.names("checks");
  for (const Node& check : root.elements("checks")) scene.checks.push_back(parse_check(check));
  return scene;
}

}  // namespace tandem::scene
