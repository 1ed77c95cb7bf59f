#include "launch/import/import.hpp"

#include <fmt/format.h>

#include <regex>
#include <system_error>

#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "common/geometry/stl_bytes.hpp"
#include "common/scene/parse.hpp"
#include "common/utf8.hpp"
#include "launch/import/base_scene.hpp"
#include "launch/import/joints.hpp"
#include "launch/import/model_format.hpp"
#include "launch/import/step_scene.hpp"
#include "launch/import/urdf_file.hpp"
#include "launch/import/walls.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The checks refer to elements of the scene; the user knows links, or bodies, and joints.
std::string element_of(const std::string& where, const Json& scene, bool is_step) {
  static const std::regex pattern(R"((mbd|dem)\.(bodies|joints|couplers|walls)\[(\d+)\])");
  std::smatch found;
  if (!std::regex_search(where, found, pattern)) return where;
  const std::string part = found[1], list = found[2];
  const char* kind = list == "bodies"  ? (is_step ? "body '" : "link '")
                     : list == "walls" ? "wall '"
                                       : "joint '";
  return kind + shortened(scene[part][list][std::stoul(found[3])]["name"].get<std::string>()) + "'";
}

void validate(const Json& scene, const std::string& model, const fs::path& folder, bool is_step) {
  try {
    const scene::Scene parsed = scene::parse(scene.dump(), model);
    scene::validate(parsed, model);
    scene::validate_files(parsed, model, folder);
  } catch (const Error& error) {
    const std::string element = element_of(error.where(), scene, is_step);
    throw Error(error.code(), error.problem(), element == error.where() ? element : model + ": " + element,
                error.hint());
  }
}

// Lists and objects without nested ones are written on one line.
void write(const Json& value, const std::string& indent, std::string& text) {
  const auto is_flat = [](const Json& json) {
    return std::none_of(json.begin(), json.end(), [](const Json& item) { return item.is_structured(); });
  };
  if (!value.is_structured() || is_flat(value)) {
    text += value.dump(-1);
    return;
  }
  const std::string inner = indent + "  ";
  text += value.is_array() ? "[" : "{";
  const char* separator = "\n";
  for (const auto& [key, item] : value.items()) {
    text += separator + inner + (value.is_array() ? "" : Json(key).dump() + ": ");
    write(item, inner, text);
    separator = ",\n";
  }
  text += "\n" + indent + (value.is_array() ? "]" : "}");
}

// Options that would do nothing are refused.
void expect_options_of(bool is_step, const ImportOptions& options) {
  const auto refuse = [&](bool given, const char* option) {
    if (given)
      throw Error(ErrorCode::usage,
                  fmt::format("{} has no meaning for a {} file", option, is_step ? "STEP" : "URDF"),
                  options.model.string(), "leave it out");
  };
  if (is_step) {
    refuse(options.free_root, "--free-root");
    refuse(options.stops.has_value(), "--stops");
    return;
  }
  refuse(!options.densities.empty(), "--density");
  refuse(!options.merge.empty(), "--merge");
  refuse(!options.ground.empty(), "--ground");
  refuse(options.fuse_smaller_than > 0, "--fuse-smaller-than");
  refuse(options.deviation.has_value(), "--deviation");
  refuse(options.joints, "--joints");
  refuse(options.into.empty() && !options.materials.empty(), "--material without --into");
}

}  // namespace

Imported import_urdf(const ImportOptions& options) {
  const std::string file = options.model.string();
  const UrdfFile urdf = read_urdf(options.model);
  Imported imported;
  imported.notes = urdf.unread;

  const LinkFrames frames = place_links(*urdf.model, options.free_root, file);
  imported.scene = base_scene(options, urdf.model->getName());
  imported.scene["mbd"]["bodies"] = bodies_of(*urdf.model, frames, file);
  imported.scene["mbd"]["joints"] =
      joints_of(*urdf.model, frames, {options.free_root, options.stops}, file, imported.notes);
  if (Json couplers = couplers_of(*urdf.model, frames, file, imported.notes); !couplers.empty())
    imported.scene["mbd"]["couplers"] = std::move(couplers);
  const fs::path folder = options.output.empty() ? fs::path(".") : options.output.parent_path();
  if (options.into.empty()) {
    add_graphics(*urdf.model, frames, options, folder, imported.scene["mbd"]["bodies"], imported.notes);
  } else {
    add_walls(*urdf.model, frames, options, folder, imported.scene["dem"], imported.notes);
  }
  validate(imported.scene, file, folder, false);
  return imported;
}

void import_model(const ImportOptions& options) {
  std::error_code unknown;
  for (const fs::path& input : {options.model, options.into})
    if (!options.output.empty() && !input.empty() && fs::equivalent(options.output, input, unknown))
      throw Error(ErrorCode::usage, "is an input of this import: it would be overwritten",
                  options.output.string(), "give another --output");
  if (!options.replace && fs::symlink_status(options.output, unknown).type() != fs::file_type::not_found &&
      !options.output.empty())
    throw Error(ErrorCode::usage, "is there: it would be overwritten", options.output.string(),
                "give another --output, or --replace");
  const bool is_step = format_of(options.model) == ModelFormat::step;
  expect_options_of(is_step, options);
  const Imported imported = is_step ? import_step(options) : import_urdf(options);
  std::string text;
  write(imported.scene, "", text);
  for (const Imported::MeshFile& mesh : imported.files) {
    fs::create_directories(mesh.file.parent_path());
    replace_file(mesh.file, stl_bytes(mesh.mesh));
  }
  // The meshes are there now, as the checks of the scene want it.
  if (is_step) validate(imported.scene, options.model.string(), options.output.parent_path(), true);
  if (options.output.empty()) {
    fmt::print("{}\n", text);
  } else {
    replace_file(options.output, text + '\n');
  }
  fmt::print("{}", imported.tables);
  for (const std::string& note : imported.notes)
    fmt::print(stderr, "{}{}\n", is_step ? "" : "not imported: ", note);
}

}  // namespace tandem::launch
