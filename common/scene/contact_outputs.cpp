// The outputs of mbd.contact: forces and points of contacts that are results.
#include <algorithm>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse_parts.hpp"
#include "common/scene/validate_parts.hpp"

namespace tandem::scene {

namespace {

// "BODY/SHAPE" of the shape of contact that has this name; empty where there is none.
std::string with_body(const Node& mbd, const std::string& shape) {
  const auto has_it = [&](const Node& owner, const char* key) {
    return std::ranges::any_of(owner.elements(key),
                               [&](const Node& s) { return s.value()["name"] == shape; });
  };
  if (has_it(mbd.at("contact"), "ground")) return "ground/" + shape;
  for (const Node& body : mbd.elements("bodies"))
    if (has_it(body, "shapes")) return body.value()["name"].get<std::string>() + "/" + shape;
  return {};
}

ContactSide parse_side(const Node& mbd, const Node& output, const std::string& text, const std::string& path,
                       const Names& bodies) {
  const std::size_t slash = text.find('/');
  const std::string name = text.substr(0, slash);
  ContactSide side;
  if (slash != std::string::npos) side.shape = text.substr(slash + 1);
  if (name == "ground") return side;
  const auto body = bodies.index(name);
  if (!body) {
    const std::string full = with_body(mbd, text);
    output.fail(path.c_str(), "unknown name '" + name + "'",
                full.empty() ? suggest_name(name, bodies.list(), "bodies")
                             : "'" + text + "' is a shape: write '" + full + "'");
  }
  side.body = BodyId{*body};
  return side;
}

std::vector<ContactSide> parse_sides(const Node& mbd, const Node& output, const char* key,
                                     const Names& bodies) {
  std::vector<ContactSide> sides;
  if (!output.has(key)) return sides;
  const nlohmann::json& value = output.value().at(key);
  for (std::size_t i = 0; i < value.size(); ++i)
    sides.push_back(parse_side(mbd, output, value[i].get<std::string>(), element(key, i), bodies));
  return sides;
}

using Shapes = std::vector<const Shape*>;

Shapes shapes_of_contact(const Scene& scene) {
  Shapes shapes;
  for (const Shape& shape : scene.contact->ground) shapes.push_back(&shape);
  for (const Shape& shape : scene.shapes)
    if (shape.use == ShapeUse::contact) shapes.push_back(&shape);
  return shapes;
}

// The shapes of the sides, each of which has at least one.
Shapes selected(const Scene& scene, const Shapes& all, const std::vector<ContactSide>& sides,
                const std::string& origin, const std::string& path) {
  Shapes chosen;
  for (const ContactSide& side : sides) {
    const std::string& body = scene.body_name(side.body);
    std::vector<std::string> names;
    for (const Shape* shape : all)
      if (shape->body == side.body) names.push_back(shape->name);
    if (names.empty())
      fail(origin, path, "'" + body + "' has no shape of contact",
           side.body == ground ? "give it one in mbd.contact.ground"
                               : "give it a shape with \"use\": \"contact\"");
    const std::size_t before = chosen.size();
    for (const Shape* shape : all)
      if (is_of(*shape, side)) chosen.push_back(shape);
    if (chosen.size() == before)
      fail(origin, path, "'" + body + "' has no shape of contact '" + side.shape + "'",
           suggest_name(side.shape, names, "shapes"));
  }
  return chosen;
}

// What else has this name, so that columns would be mixed up; or null.
const char* owner_of(const std::string& name, const Scene& scene) {
  const auto is_it = [&](const auto& named) { return named.name == name; };
  if (name == scene.body_name(ground) || std::ranges::any_of(scene.mbd->bodies, is_it)) return "a body";
  if (std::ranges::any_of(scene.mbd->joints, is_it)) return "a joint";
  if (std::ranges::any_of(scene.mbd->couplers, is_it)) return "a coupler";
  if (std::ranges::any_of(scene.mbd->forces, [&](const Force& force) { return std::visit(is_it, force); }))
    return "a force";
  if (name == "time" || name == "summary") return "a part of the results";
  return nullptr;
}

}  // namespace

std::vector<ContactOutput> parse_contact_outputs(const Node& mbd, const Names& bodies) {
  const Node contact = mbd.at("contact");
  std::vector<ContactOutput> outputs;
  contact.names("outputs");
  for (const Node& node : contact.elements("outputs")) {
    ContactOutput& output = outputs.emplace_back();
    node.read("name", output.name);
    output.on = parse_sides(mbd, node, "on", bodies);
    output.from = parse_sides(mbd, node, "from", bodies);
  }
  return outputs;
}

bool may_touch(const Scene& scene, BodyId a, BodyId b) {
  const auto is_pair = [&](BodyId one, BodyId two) {
    return (one == a && two == b) || (one == b && two == a);
  };
  const auto joins = [&](const Joint& joint) {
    return joint.type != JointType::free && is_pair(joint.parent, joint.child);
  };
  if (a == b) return false;
  if (a != ground && b != ground && std::ranges::any_of(scene.mbd->joints, joins)) return false;
  return std::ranges::none_of(scene.contact->ignore,
                              [&](const auto& pair) { return is_pair(pair[0], pair[1]); });
}

void validate_contact_outputs(const Scene& scene, const std::string& origin) {
  if (!scene.contact) return;
  const Shapes all = shapes_of_contact(scene);
  for (std::size_t i = 0; i < scene.contact->outputs.size(); ++i) {
    const ContactOutput& output = scene.contact->outputs[i];
    const std::string path = element("mbd.contact.outputs", i);
    if (const char* owner = owner_of(output.name, scene))
      fail(origin, path + ".name",
           std::string(owner) + " is called '" + output.name + "' as well, so that columns would be mixed up",
           "give the output another name, such as '" + output.name + "_contact'");
    const Shapes on = selected(scene, all, output.on, origin, path + ".on");
    Shapes from = selected(scene, all, output.from, origin, path + ".from");
    if (output.from.empty())
      std::ranges::copy_if(all, std::back_inserter(from),
                           [&](const Shape* shape) { return std::ranges::find(on, shape) == on.end(); });
    for (const Shape* shape : from)
      if (std::ranges::find(on, shape) != on.end())
        fail(origin, path + ".from",
             "the shape '" + shape->name + "' of '" + scene.body_name(shape->body) + "' is on both sides",
             "leave it out of one of them");
    const bool touches = std::ranges::any_of(on, [&](const Shape* a) {
      return std::ranges::any_of(from, [&](const Shape* b) { return may_touch(scene, a->body, b->body); });
    });
    if (!touches)
      fail(origin, path, "the two sides never touch: they are one body, joined, or in mbd.contact.ignore",
           "name bodies that may touch each other");
  }
}

}  // namespace tandem::scene
