#include "launch/import/walls.hpp"

#include <fmt/format.h>

#include <optional>

#include "common/error.hpp"
#include "common/scene/nearest_name.hpp"
#include "coordinator/mesh_import/mesh_import.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// "package://NAME/PATH" names a ROS package: a folder NAME above the model. Other names are relative to the
// model.
fs::path mesh_file(const std::string& name, const fs::path& model) {
  const std::string package = "package://", file = "file://";
  if (name.starts_with(file)) return name.substr(file.size());
  if (!name.starts_with(package)) return model.parent_path() / name;
  const fs::path rest = name.substr(package.size());
  for (fs::path folder = fs::absolute(model).parent_path();; folder = folder.parent_path()) {
    if (folder.filename() == *rest.begin()) return folder.parent_path() / rest;
    if (fs::exists(folder / rest)) return folder / rest;
    if (folder == folder.root_path()) break;
  }
  throw Error(ErrorCode::scene, "the mesh '" + name + "' is not found", {},
              "there is no folder '" + rest.begin()->string() + "' above the model");
}

// None for a shape that a scene does not have.
std::optional<Json> shape_of(const urdf::Geometry& geometry, const fs::path& model, const fs::path& folder) {
  switch (geometry.type) {
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      return Json{{"type", "box"}, {"size", {size.x, size.y, size.z}}};
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return Json{{"type", "cylinder"}, {"radius", cylinder.radius}, {"height", cylinder.length}};
    }
    case urdf::Geometry::SPHERE:
      return Json{{"type", "sphere"}, {"radius", static_cast<const urdf::Sphere&>(geometry).radius}};
    case urdf::Geometry::MESH: {
      const auto& mesh = static_cast<const urdf::Mesh&>(geometry);
      const urdf::Vector3& scale = mesh.scale;
      if (!(scale.x > 0 && scale.y > 0 && scale.z > 0))
        throw Error(
            ErrorCode::scene,
            fmt::format("the mesh '{}' has the scale {} {} {}", mesh.filename, scale.x, scale.y, scale.z), {},
            "a scene takes positive scales only: mirror the mesh itself");
      const fs::path file = mesh_file(mesh.filename, model);
      import_mesh(file, scale.x);  // reports a wrong mesh together with its link
      Json shape{{"type", "mesh"}, {"file", fs::proximate(file, folder).string()}, {"scale", scale.x}};
      if (scale.y != scale.x || scale.z != scale.x)
        shape["stretch"] = {1, scale.y / scale.x, scale.z / scale.x};
      return shape;
    }
    default:
      return {};
  }
}

// The name of --material, which has to be one of the scene's.
std::string wall_material(const Json& dem, const ImportOptions& options) {
  if (options.materials.size() != 1)
    throw Error(ErrorCode::usage, "a URDF model takes one material for all its walls", "--material",
                "give one name of " + options.into.string());
  const std::string& wanted = options.materials.front();
  std::vector<std::string> names;
  for (const Json& material : dem.value("materials", Json::array()))
    if (material.is_object()) names.push_back(material.value("name", ""));
  if (std::find(names.begin(), names.end(), wanted) == names.end())
    throw Error(ErrorCode::usage, "there is no material '" + wanted + "' in " + options.into.string(),
                "--material", suggest_name(wanted, names, "materials"));
  return wanted;
}

}  // namespace

void add_walls(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
               const fs::path& folder, Json& dem, std::vector<std::string>& notes) {
  const std::string material = wall_material(dem, options);
  for (const auto& [name, link] : model.links_) {
    const LinkFrame& frame = frames.at(name);
    if (!link->visual_array.empty())
      notes.push_back("link '" + name + "': <visual>: a scene draws the walls, made of <collision>");
    for (std::size_t i = 0; i < link->collision_array.size(); ++i) {
      const urdf::Collision& collision = *link->collision_array[i];
      std::optional<Json> shape;
      try {
        shape = shape_of(*collision.geometry, options.model, folder);
      } catch (const Error& error) {
        const std::string what =
            error.where().empty() ? error.problem() : error.where() + ": " + error.problem();
        throw Error(error.code(), what, options.model.string() + ": link '" + name + "'", error.hint());
      }
      if (!shape) {
        notes.push_back("link '" + name +
                        "': the sphere of <collision>: a scene has no round walls but meshes");
        continue;
      }
      // From the link's frame by way of the world to the body's frame.
      const Pose shape_in_world = frame.pose * pose_of(collision.origin);
      const Quat q_BW = frame.q_WB.conjugate();
      const std::string suffix = link->collision_array.size() > 1 ? fmt::format("_{}", i + 1) : "";
      dem["walls"].push_back({{"name", name + suffix},
                              {"body", frame.body},
                              {"material", material},
                              {"position", list(q_BW.rotate(shape_in_world.p_WB - frame.p_WB))},
                              {"orientation", list((q_BW * shape_in_world.q_WB).normalized())},
                              {"shape", *shape}});
    }
  }
}

void add_graphics(const urdf::ModelInterface& model, const LinkFrames& frames, const ImportOptions& options,
                  const fs::path& folder, Json& bodies, std::vector<std::string>& notes) {
  for (const auto& [name, link] : model.links_) {
    const LinkFrame& frame = frames.at(name);
    const bool has_walls = !link->collision_array.empty(), on_ground = frame.body == "ground";
    if (has_walls && on_ground)
      notes.push_back("link '" + name +
                      "': <collision>: walls need particles, import --into a scene that has some");
    if (!link->visual_array.empty() && (has_walls || on_ground))
      notes.push_back("link '" + name + "': <visual>: a scene draws the walls, made of <collision>");
    if (on_ground) continue;
    Json& body = *std::find_if(bodies.begin(), bodies.end(),
                               [&](const Json& each) { return each["name"] == frame.body; });
    const auto add = [&](const urdf::Geometry& geometry, const urdf::Pose& origin, std::size_t number) {
      std::optional<Json> shape;
      try {
        shape = shape_of(geometry, options.model, folder);
      } catch (const Error& error) {
        // A picture is not worth an error: the machine moves without it.
        notes.push_back("link '" + name + "': " + error.problem());
      }
      if (!shape) return;
      const Pose in_world = frame.pose * pose_of(origin);
      const Quat q_BW = frame.q_WB.conjugate();
      body["shapes"].push_back({{"name", fmt::format("{}_{}", name, number)},
                                {"use", "graphics"},
                                {"position", list(q_BW.rotate(in_world.p_WB - frame.p_WB))},
                                {"orientation", list((q_BW * in_world.q_WB).normalized())},
                                {"shape", *shape}});
    };
    std::size_t number = 0;
    for (const auto& collision : link->collision_array)
      add(*collision->geometry, collision->origin, ++number);
    if (!has_walls)
      for (const auto& visual : link->visual_array) add(*visual->geometry, visual->origin, ++number);
  }
}

}  // namespace tandem::launch
