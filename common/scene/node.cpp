#include "common/scene/node.hpp"

#include <algorithm>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/tolerance.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

std::string joined(const std::string& path, const char* key) {
  return path.empty() ? key : path + "." + key;
}

}  // namespace

Node Node::at(const char* key) const {
  return {value_.at(key), joined(path_, key), origin_};
}

std::vector<Node> Node::elements(const char* key) const {
  std::vector<Node> nodes;
  if (!has(key)) return nodes;
  const nlohmann::json& list = value_.at(key);
  for (std::size_t i = 0; i < list.size(); ++i)
    nodes.emplace_back(list[i], element(joined(path_, key), i), origin_);
  return nodes;
}

void Node::read(const char* key, Vec3d& target) const {
  if (!has(key)) return;
  const nlohmann::json& list = value_.at(key);
  target = {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

void Node::read(const char* key, Quat& target) const {
  if (!has(key)) return;
  const nlohmann::json& list = value_.at(key);
  target = {list[0].get<double>(), list[1].get<double>(), list[2].get<double>(), list[3].get<double>()};
  if (is_unit(std::sqrt(target.norm2()))) target = target.normalized();
}

void Node::read_unit(const char* key, Vec3d& target) const {
  read(key, target);
  if (is_unit(norm(target))) target = normalized(target);
}

Names Node::names(const char* key, const std::vector<std::string>& reserved) const {
  Names names;
  for (const Node& node : elements(key)) {
    const auto name = node.value().at("name").get<std::string>();
    if (std::find(reserved.begin(), reserved.end(), name) != reserved.end())
      node.fail("name", "the name '" + name + "' is reserved", "choose another name");
    if (!names.add(name))
      node.fail("name", "the name '" + shortened(name) + "' is given twice",
                "names in " + joined(path_, key) + " must differ");
  }
  return names;
}

std::uint32_t Node::resolve(const char* key, const Names& names, const char* kind) const {
  const auto name = value_.at(key).get<std::string>();
  const std::optional<std::uint32_t> index = names.index(name);
  if (!index) fail(key, "unknown name '" + shortened(name) + "'", suggest_name(name, names.list(), kind));
  return *index;
}

void Node::fail(const std::string& problem, const std::string& hint) const {
  scene::fail(origin_, path_, problem, hint);
}

void Node::fail(const char* key, const std::string& problem, const std::string& hint) const {
  scene::fail(origin_, joined(path_, key), problem, hint);
}

}  // namespace tandem::scene
