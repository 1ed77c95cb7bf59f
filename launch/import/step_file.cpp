#include "launch/import/step_file.hpp"

#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "coordinator/mesh_import/mesh_import.hpp"
#include "launch/import/step_child.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

StepFace face_of(const Json& json) {
  StepFace face{.is_plane = json.at("kind") == "plane",
                .point = vector_of(json.at("point")),
                .direction = {},
                .first = json.at("first").get<std::size_t>(),
                .count = json.at("count").get<std::size_t>()};
  face.direction = vector_of(json.at(face.is_plane ? "normal" : "axis"));
  if (face.is_plane) {
    face.area = json.at("area").get<double>();
  } else {
    face.radius = json.at("radius").get<double>();
    face.is_hole = json.at("hole").get<bool>();
    face.begin = json.at("begin").get<double>();
    face.end = json.at("end").get<double>();
    face.angle = json.at("angle").get<double>();
  }
  return face;
}

StepProduct product_of(const Json& json, const fs::path& mesh) {
  StepProduct product{
      .name = json.at("name").get<std::string>(), .unit = {}, .low = {}, .high = {}, .mesh = {}, .faces = {}};
  if (json.at("solids") == 0) return product;
  product.unit = {.mass = json.at("volume").get<double>(),
                  .centre = vector_of(json.at("centre")),
                  .inertia = json.at("inertia").get<std::array<double, 6>>()};
  product.low = vector_of(json.at("low"));
  product.high = vector_of(json.at("high"));
  product.deviation = json.at("deviation").get<double>();
  product.stated_deviation = json.at("stated_deviation").get<double>();
  product.mesh = import_mesh(mesh, 1);
  for (const Json& face : json.at("features")) product.faces.push_back(face_of(face));
  return product;
}

void add_parts(const Json& node, std::vector<std::string> path, std::vector<StepPart>& parts) {
  path.push_back(node.at("name").get<std::string>());
  if (node.contains("children")) {
    for (const Json& child : node["children"]) add_parts(child, path, parts);
    return;
  }
  const auto q = node.at("orientation").get<std::array<double, 4>>();
  StepPart part{.path = std::move(path),
                .product = node.at("product").get<std::size_t>(),
                .pose = {vector_of(node.at("position")), Quat{q[0], q[1], q[2], q[3]}.normalized()},
                .colour = {},
                .material = node.value("material", "")};
  if (node.contains("colour")) part.colour = node["colour"].get<std::array<double, 3>>();
  parts.push_back(std::move(part));
}

}  // namespace

StepFile read_step(const fs::path& file, std::optional<double> deviation) {
  const TemporaryFolder folder;
  run_tandem_step(file, folder.path(), deviation, std::chrono::minutes(10));
  const Json json = Json::parse(read_input(folder.path() / "parts.json", {.largest = largest_mesh}));
  StepFile step{.unit = json.at("unit").get<std::string>(),
                .faults = json.at("faults").get<std::size_t>(),
                .first_fault = json.at("first_fault").get<std::string>(),
                .products = {},
                .parts = {}};
  for (const Json& product : json.at("products"))
    step.products.push_back(
        product_of(product, folder.path() / (std::to_string(step.products.size()) + ".stl")));
  add_parts(json.at("tree"), {}, step.parts);
  return step;
}

}  // namespace tandem::launch
