#include "coordinator/scene/kept_scene.hpp"

#include <fmt/format.h>

#include <system_error>

#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "common/scene/parse.hpp"
#include "common/state_file.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "coordinator/scene/scene_paths.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t largest_copy = std::uintmax_t{64} << 20;  // [bytes]

fs::path absolute(const Json& name, const fs::path& folder) {
  return fs::absolute(scene::resolve_file(name.get<std::string>(), folder)).lexically_normal();
}

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code failure;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
  // Permissions are copied as well, and the next run removes the file.
  if (!failure) fs::permissions(to, fs::perms::owner_write, fs::perm_options::add, failure);
  if (failure)
    throw Error(ErrorCode::resource, "cannot be written: " + failure.message(), to.string(),
                "free some space on the disk");
}

}  // namespace

void keep_scene(const SceneFile& file, const fs::path& folder) {
  const fs::path from = fs::path(file.origin).parent_path(), to = folder / scene_folder;
  std::error_code failure;
  fs::create_directories(to, failure);
  if (failure)
    throw Error(ErrorCode::resource, "cannot be created: " + failure.message(), to.string(),
                "free some space on the disk");
  Json scene = Json::parse(file.given);
  for_each_file(scene, [&](Json& name) {
    const fs::path path = absolute(name, from);
    name = path.string();
    if (fs::file_size(path, failure) > largest_copy || failure) return;
    const std::string kept = fmt::format("file_{:016x}{}", file_digest(path), path.extension().string());
    copy_to(path, to / kept);
    name = kept;
  });
  make_other_paths_absolute(scene, from);
  replace_file(to / kept_scene_name, scene.dump(2) + '\n');
}

fs::path scene_of_run(const fs::path& folder, const nlohmann::json& summary) {
  std::error_code failure;
  fs::path copy = folder / scene_folder / kept_scene_name;
  if (fs::exists(copy, failure)) return copy;
  return summary.value("scene_file", "");
}

}  // namespace tandem::launch
