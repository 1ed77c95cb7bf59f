#include "coordinator/run_folder/own_files.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

constexpr std::array own_names{std::string_view(summary_name),        std::string_view("run.log"),
                               std::string_view("bodies.csv"),        std::string_view("joints.csv"),
                               std::string_view("windows.csv"),       std::string_view("border.csv"),
                               std::string_view("elements.csv"),      std::string_view("sensors.csv"),
                               std::string_view("control.csv"),       std::string_view("particles.h5"),
                               std::string_view("contacts.h5"),       std::string_view("contacts.xdmf"),
                               std::string_view("particles.xdmf"),    std::string_view("bodies.h5"),
                               std::string_view("bodies.xdmf"),       std::string_view("report.html"),
                               std::string_view("report.log"),        std::string_view("picture.png"),
                               std::string_view("picture.pov"),       std::string_view("picture.log"),
                               std::string_view("movie.mp4"),         std::string_view("movie.log"),
                               std::string_view(marker_name),         std::string_view(reserve_name),
                               std::string_view("liquid.h5"),         std::string_view("liquid.xdmf"),
                               std::string_view(last_windows_name),   std::string_view("liquid_particles.h5"),
                               std::string_view("liquid_surface.h5"), std::string_view("liquid_surface.log")};
constexpr std::array checkpoint_names{std::string_view("run.h5"), std::string_view("mbd.h5"),
                                      std::string_view("dem.h5"), std::string_view("sph.h5")};
constexpr std::size_t most_others = 10;

// The names under which files are written first.
std::string_view without_draft(std::string_view name) {
  for (const std::string_view ending : {".new", ".part"})
    if (name.ends_with(ending)) return name.substr(0, name.size() - ending.size());
  return name;
}

bool is_number(std::string_view text) {
  return text.size() >= 6 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// A picture of `tandem movie` that was ended, or what it was made of.
bool is_still(std::string_view name) {
  if (name == "liquid_particles.h5" || name == "liquid_surface.h5" || name == "liquid_surface.log")
    return true;
  constexpr std::string_view begin = "still_";
  if (!name.starts_with(begin)) return false;
  name.remove_prefix(begin.size());
  for (const std::string_view end : {".png", ".pov", ".pov-state", ".log"})
    if (name.ends_with(end)) return is_number(name.substr(0, name.size() - end.size()));
  return false;
}

// The copy of the scene, or of a file that it names: "file_0123456789abcdef.stl".
bool is_of_scene(std::string_view name) {
  constexpr std::string_view begin = "file_";
  constexpr std::size_t digits = 16;
  if (name == kept_scene_name) return true;
  if (!name.starts_with(begin) || name.size() < begin.size() + digits) return false;
  name.remove_prefix(begin.size());
  return name.substr(0, digits).find_first_not_of("0123456789abcdef") == std::string_view::npos &&
         (name.size() == digits || name[digits] == '.');
}

bool is_frame(std::string_view name) {
  if (name == "surfaces.h5") return true;
  if (!name.ends_with(".h5")) return false;
  name.remove_suffix(3);
  for (const std::string_view series : {"particles_", "liquid_", "bodies_", "contacts_"})
    if (name.starts_with(series)) return is_number(name.substr(series.size()));
  return false;
}

constexpr std::string_view window = "window_";

bool contains(const auto& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The name in the first run that corresponds to a name in the second run of --estimate richardson.
fs::path as_of_one_run(const fs::path& name) {
  return *name.begin() == half_steps_folder && name != half_steps_folder
             ? name.lexically_relative(half_steps_folder)
             : name;
}

bool is_own_folder(const fs::path& name) {
  const fs::path own = as_of_one_run(name);
  const std::string last = own.filename().string();
  if (own == frames_folder || own == checkpoint_folder || own == stills_folder || own == scene_folder)
    return true;
  if (own == half_steps_folder) return name == own;
  return own.parent_path() == checkpoint_folder && last.starts_with(window) &&
         is_number(last.substr(window.size()));
}

void remove_in(const fs::path& root, const fs::path& below, std::vector<std::string>& others) {
  std::error_code failure, ignored;
  for (fs::directory_iterator at(root / below, failure); !failure && at != fs::directory_iterator();
       at.increment(failure)) {
    const fs::path name = below / at->path().filename();
    if (name.filename() == marker_name) continue;
    const bool folder = at->symlink_status(ignored).type() == fs::file_type::directory;
    // The second run has a marker too, which is removed last.
    const bool marked = name != half_steps_folder || fs::exists(at->path() / marker_name, ignored);
    if (folder && marked && is_own_folder(name)) {
      remove_in(root, name, others);
      if (name == half_steps_folder) fs::remove(at->path() / marker_name, ignored);
      fs::remove(at->path(), ignored);  // fails where the folder holds other files
    } else if (!folder && is_own_file(name)) {
      if (fs::remove(at->path(), failure); failure)
        throw Error(ErrorCode::resource, "the file of an earlier run cannot be removed: " + failure.message(),
                    at->path().string(), "give another --out, or the right to write there");
    } else if (others.size() < most_others) {
      others.push_back(name.string() + (folder ? "/" : ""));
    }
  }
  if (failure)
    throw Error(ErrorCode::resource, "cannot be emptied: " + failure.message(), (root / below).string(),
                "give another --out, or the right to write there");
}

}  // namespace

bool is_own_file(const fs::path& name) {
  const std::string file(without_draft(name.filename().string()));
  const fs::path folder = as_of_one_run(name).parent_path();
  if (folder.empty()) return contains(own_names, file);
  if (folder == frames_folder) return is_frame(file);
  if (folder == stills_folder) return is_still(file);
  if (folder == scene_folder) return is_of_scene(file);
  return folder.parent_path() == checkpoint_folder && is_own_folder(folder) &&
         contains(checkpoint_names, file);
}

std::vector<std::string> remove_own_files(const fs::path& folder) {
  std::vector<std::string> others;
  remove_in(folder, {}, others);
  return others;
}

}  // namespace tandem::launch
