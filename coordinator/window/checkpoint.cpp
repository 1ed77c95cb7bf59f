#include "coordinator/window/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/log.hpp"
#include "common/scene/document.hpp"
#include "common/utf8.hpp"
#include "coordinator/run_folder/own_files.hpp"
#include "protocol/layout.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

constexpr const char *state_kind = "tandem coordinator state", *run_file = "run.h5";
// Version of the state of Coupler and its members, and of the marks of the row files.
constexpr std::uint64_t state_version = 9;

// "mbd.h5", and what is known of it in the file of the coordinator.
std::string file_of(protocol::Role role) {
  return std::string(protocol::word_of(role)) + ".h5";
}
std::string digest_of(protocol::Role role) {
  return std::string("digest_of_") + protocol::word_of(role);
}
std::string program_of(protocol::Role role) {
  return std::string("program_of_") + protocol::word_of(role);
}

// The solvers of the run, that of the bodies first.
std::vector<protocol::Remote*> all_of(const Solvers& solvers) {
  std::vector<protocol::Remote*> all;
  if (solvers.mbd) all.push_back(solvers.mbd);
  all.insert(all.end(), solvers.loads.begin(), solvers.loads.end());
  return all;
}

// The marks of the row files, under the names "bodies", "joints", "elements" and "sensors".
void save_or_restore(Archive& archive, const Results& results, std::vector<RowMark>& marks) {
  const std::vector<const Signals*> signals = results.signals();
  marks.resize(signals.size());
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const std::string name = signals[i]->file().stem().string();
    archive(name + ".size", marks[i].size);
    archive(name + ".digest", marks[i].digest);
    archive(name + ".lines", marks[i].lines);
  }
}

// The scene without the parts that may differ between a checkpoint and the run that continues from it.
nlohmann::json physics_of(const std::string& scene_text) {
  nlohmann::json scene = nlohmann::json::parse(scene_text);
  for (const char* free : {"end_time", "checks", "name", "description"}) scene.erase(free);
  // The particle solver sums these from the start, so that its state is one of them.
  const nlohmann::json given = scene.value("output", nlohmann::json::object());
  scene["output"] = {{"wall_fields", given.value("wall_fields", nlohmann::json::array())},
                     {"dissipation", given.value("dissipation", false)}};
  return scene;
}

// "/dem/materials/0/young" in the notation of messages: "dem.materials[0].young".
std::string dotted(const std::string& pointer) {
  std::string text;
  for (std::size_t begin = 1; begin <= pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', begin), pointer.size());
    const std::string part = pointer.substr(begin, end - begin);
    const bool index = !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    text += index ? "[" + part + "]" : (text.empty() ? "" : ".") + part;
    begin = end + 1;
  }
  return text;
}

std::string value_at(const nlohmann::json& json, const std::string& pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return json.contains(at) ? shortened(json.at(at).dump(), 60) : "nothing";
}

// The scene of the file. Its depth is limited as for a scene file, because the comparison is recursive.
nlohmann::json scene_in(const StateReader& file) {
  try {
    return scene::read_document(file.text("scene"), "its scene");
  } catch (const Error& error) {
    throw Error(ErrorCode::resource, std::string("is damaged: ") + error.what(), file.path().string(),
                "continue from another checkpoint");
  }
}

// Names of the elements of a list in a scene; empty where the scene does not have the list.
std::vector<std::string> names_in(const nlohmann::json& scene, const std::string& part,
                                  const std::string& list) {
  std::vector<std::string> names;
  const auto of_part = scene.find(part);
  if (of_part == scene.end() || !of_part->is_object() || !of_part->contains(list) ||
      !of_part->at(list).is_array())
    return names;
  for (const nlohmann::json& element : of_part->at(list))
    if (element.is_object() && element.contains("name") && element["name"].is_string())
      names.push_back(element["name"]);
  return names;
}

// A sentence that names the first element which only one of the two scenes has; empty where there is none.
std::string added_or_removed(const nlohmann::json& saved, const nlohmann::json& ours) {
  for (const std::string part : {"mbd", "dem", "sph"}) {
    if (!ours.contains(part) || !ours[part].is_object()) continue;
    for (const auto& [list, elements] : ours[part].items()) {
      const std::vector<std::string> there = names_in(saved, part, list), here = names_in(ours, part, list);
      const auto first_beyond = [](const std::vector<std::string>& names,
                                   const std::vector<std::string>& known) {
        return std::ranges::find_if(
            names, [&](const std::string& name) { return std::ranges::find(known, name) == known.end(); });
      };
      if (const auto added = first_beyond(here, there); here.size() > there.size() && added != here.end())
        return fmt::format("{}.{} has '{}' here, and not there", part, list, shortened(*added));
      if (const auto removed = first_beyond(there, here);
          here.size() < there.size() && removed != there.end())
        return fmt::format("{}.{} has '{}' there, and not here", part, list, shortened(*removed));
    }
  }
  return {};
}

// The first change of a patch.
std::string first_change(const nlohmann::json& saved, const nlohmann::json& ours,
                         const nlohmann::json& change) {
  const std::string pointer = change.at("path");
  if (pointer.ends_with("/-"))  // an additional element at the end of a list
    return fmt::format("{} has one more element here: {}", dotted(pointer.substr(0, pointer.size() - 2)),
                       shortened(change.at("value").dump(), 60));
  return fmt::format("{} is {} there, and {} here", dotted(pointer), value_at(saved, pointer),
                     value_at(ours, pointer));
}

void expect_same_scene(const nlohmann::json& saved, const nlohmann::json& ours, const fs::path& path) {
  const nlohmann::json patch = nlohmann::json::diff(saved, ours);
  if (patch.empty()) return;
  std::string difference = added_or_removed(saved, ours);
  if (difference.empty()) difference = first_change(saved, ours, patch[0]);
  throw Error(ErrorCode::scene, "is of another scene: " + difference, path.string(),
              "give the scene that the state was saved from; only end_time, checks, name, description and "
              "output without wall_fields and dissipation may change");
}

// FNV-1a over meshes and particle files, which the scene refers to by name.
std::uint64_t digest(const SceneFile& file) {
  std::uint64_t hash = protocol::layout::start;
  const auto add = [&hash](const void* data, std::size_t size) {
    hash = protocol::layout::add(hash, std::string_view(static_cast<const char*>(data), size));
  };
  for (const protocol::NamedMesh& mesh : file.meshes) {
    add(mesh.mesh.vertices.data(), mesh.mesh.vertices.size() * sizeof(mesh.mesh.vertices[0]));
    add(mesh.mesh.triangles.data(), mesh.mesh.triangles.size() * sizeof(mesh.mesh.triangles[0]));
  }
  for (const protocol::NamedText& text : file.files) add(text.text.data(), text.text.size());
  return hash;
}

protocol::Checkpoint order_of(const Coupler& coupler, const fs::path& file) {
  return {coupler.accounts().windows(), coupler.now(), file.string()};
}

}  // namespace

namespace {

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directory(folder, failure);
  if (failure)
    throw Error(ErrorCode::resource, "cannot be created: " + failure.message(), folder.string(),
                "is the folder of the run there, and is there space left on the disk?");
}

}  // namespace

Nanoseconds checkpoint_interval(double seconds) {
  if (!(seconds >= 1e-9 && seconds <= 9e9))
    throw Error(ErrorCode::usage, fmt::format("{:g} s is no time between restart files", seconds),
                "--checkpoint-every", "give 1e-9 to 9e9 s of simulated time");
  return to_nanoseconds(seconds);
}

Checkpoints::Checkpoints(const SceneFile& file, const fs::path& run_folder, Nanoseconds every,
                         Nanoseconds from)
    : file_(file), folder_(fs::absolute(run_folder) / checkpoint_folder), every_(every), from_(from) {
  make_folder(folder_);
}

void Checkpoints::write(const Solvers& solvers, Coupler& coupler, Results& results) {
  const fs::path folder = folder_ / fmt::format("window_{:06}", coupler.accounts().windows());
  if (folder == last_) return;
  // Creates this folder only and not its parents: a run whose folder was deleted must end.
  make_folder(folder);
  std::error_code failure;
  try {
    write_files(folder, solvers, coupler, results);
    // Makes the name of the new folder durable before the old folder is removed.
    flush_to_disk(folder_);
  } catch (...) {
    fs::remove_all(folder, failure);
    throw;
  }
  log::debug("checkpoint {}", folder.string());
  if (!last_.empty()) fs::remove_all(last_, failure);
  last_ = folder;
  written_ = intervals(coupler.now());
}

void Checkpoints::write_files(const fs::path& folder, const Solvers& solvers, Coupler& coupler,
                              Results& results) const {
  const std::vector<protocol::Remote*> all = all_of(solvers);
  for (protocol::Remote* solver : all)
    solver->checkpoint(order_of(coupler, folder / file_of(solver->role())));

  StateWriter file(folder / run_file, state_kind, state_version);
  for (const protocol::Remote* solver : all)
    file.write(digest_of(solver->role()), file_digest(folder / file_of(solver->role())));
  for (const protocol::Remote* solver : all) file.write(program_of(solver->role()), solver->program());
  file.write("layout_hash", std::uint64_t{protocol::layout_hash});
  file.write("scene", physics_of(file_.text).dump());
  file.write("files", digest(file_));
  Archive archive(file);
  coupler.save_or_restore(archive);
  // The rows stay in their own files, which are only appended to.
  results.flush_rows();
  std::vector<RowMark> marks;
  for (const Signals* signals : results.signals()) marks.push_back(signals->mark());
  save_or_restore(archive, results, marks);
  file.commit();
}

namespace {

constexpr const char* run_with_checkpoints =
    "--restart takes the folder of a run that was started with --checkpoint-every";

void expect_readable(const std::error_code& failure, const fs::path& path) {
  if (failure)
    throw Error(ErrorCode::usage, "cannot be read: " + failure.message(), path.string(),
                run_with_checkpoints);
}

bool is_there(const fs::path& path) {
  std::error_code failure;
  const bool found = fs::exists(path, failure);
  expect_readable(failure, path);
  return found;
}

// N of "window_N".
std::optional<std::uint64_t> window_of(const std::string& name) {
  constexpr std::string_view before = "window_";
  if (!name.starts_with(before)) return {};
  std::uint64_t window = 0;
  const char* end = name.data() + name.size();
  const auto [rest, failure] = std::from_chars(name.data() + before.size(), end, window);
  return failure == std::errc() && rest == end ? std::optional(window) : std::nullopt;
}

// The file may belong to another run with the same time and scene.
void expect_part(const StateReader& run, const std::string& name, const fs::path& path) {
  std::uint64_t digest = 0;
  run.read(name, digest);
  if (file_digest(path) != digest)
    throw Error(ErrorCode::resource, "is not the file that " + run.path().string() + " was written with",
                path.string(), "give the files of one checkpoint");
}

// The program without its version, which the state file of a solver checks by itself.
std::string name_of_program(const std::string& program) {
  return program.substr(0, program.rfind(' '));
}

// A solver cannot read the state of another one, and some would not notice.
void expect_program(const StateReader& run, const protocol::Remote& solver) {
  const protocol::Role role = solver.role();
  const std::string wrote = run.text(program_of(role));
  if (name_of_program(wrote) == name_of_program(solver.program())) return;
  throw Error(
      ErrorCode::usage,
      fmt::format("its state of {} was written by {}, and here {} runs", protocol::name(role),
                  printable(shortened(wrote)), printable(shortened(solver.program()))),
      run.path().string(),
      fmt::format("continue with that program (--{}-server), or start from the begin, without --restart",
                  protocol::word_of(role)));
}

// The folder with the row files of a checkpoint: that of its run, or the checkpoint's own where a user has
// copied them there.
fs::path folder_of_rows(const fs::path& checkpoint) {
  if (is_there(checkpoint / "bodies.csv")) return checkpoint;
  const fs::path run = checkpoint.parent_path().parent_path();
  if (is_there(run / "bodies.csv")) return run;
  throw Error(ErrorCode::usage,
              "lacks the rows of its run: bodies.csv, joints.csv, elements.csv and sensors.csv",
              checkpoint.string(),
              "keep a checkpoint in the folder of its run, or put these files beside its run.h5");
}

}  // namespace

fs::path find_checkpoint(const fs::path& path) {
  if (!is_there(path)) throw Error(ErrorCode::usage, "does not exist", path.string(), run_with_checkpoints);
  if (path.filename() == run_file) return path.parent_path();
  if (is_there(path / run_file)) return path;
  std::optional<std::uint64_t> newest;
  fs::path found;
  for (const fs::path& folder : {path, path / checkpoint_folder}) {
    if (!is_there(folder)) continue;
    std::error_code failure;
    for (fs::directory_iterator entry(folder, failure); !failure && entry != fs::directory_iterator();
         entry.increment(failure)) {
      const auto window = window_of(entry->path().filename().string());
      if (window && window >= newest && is_there(entry->path() / run_file))
        newest = window, found = entry->path();
    }
    if (failure != std::errc::not_a_directory) expect_readable(failure, folder);
  }
  if (!newest)
    throw Error(ErrorCode::usage, "holds no complete checkpoint", path.string(), run_with_checkpoints);
  return found;
}

void resume(const fs::path& checkpoint, const SceneFile& scene, const Solvers& solvers, Coupler& coupler,
            Results& results) {
  const fs::path folder = fs::absolute(checkpoint);
  const StateReader file(folder / run_file, state_kind, state_version);
  std::uint64_t layout = 0, files = 0;
  file.read("layout_hash", layout);
  if (layout != protocol::layout_hash)
    throw Error(ErrorCode::resource, "was written by a program of another protocol", file.path().string(),
                "continue with the program that wrote it");
  const nlohmann::json saved = scene_in(file);
  expect_same_scene(saved, physics_of(scene.text), file.path());
  file.read("files", files);
  if (files != digest(scene))
    throw Error(ErrorCode::scene, "is of a scene with other meshes or particle files", file.path().string(),
                "give the files that the state was saved with");
  const std::vector<protocol::Remote*> all = all_of(solvers);
  for (const protocol::Remote* solver : all) expect_program(file, *solver);
  Archive archive(file);
  coupler.save_or_restore(archive);
  for (protocol::Remote* solver : all) {
    const fs::path state = folder / file_of(solver->role());
    expect_part(file, digest_of(solver->role()), state);
    solver->resume(order_of(coupler, state));
  }
  std::vector<RowMark> marks;
  save_or_restore(archive, results, marks);
  results.begin_with(folder_of_rows(folder), marks);
  log::info("continues from {} at t = {:.6g} s, window {}", folder.string(), to_seconds(coupler.now()),
            coupler.accounts().windows());
}

}  // namespace tandem::launch
