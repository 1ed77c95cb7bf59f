#include "coordinator/start/server_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/command_line.hpp"
#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/report/data_folder.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;
using protocol::Role;

struct Names {
  std::string option, key, part;
};
Names names_of(Role role) {
  const std::string word = protocol::word_of(role);
  const char* part = role == Role::mbd ? "bodies" : role == Role::dem ? "particles" : "liquid";
  return {"--" + word + "-server", word + ".server", part};
}

// Whether the scene has what a server of this role computes, and the command that the scene names for it.
bool has_part(Role role, const scene::Scene& scene) {
  return role == Role::mbd   ? scene.mbd.has_value()
         : role == Role::dem ? scene.dem.has_value()
                             : scene.sph.has_value();
}

const std::optional<std::string>& option_of(Role role, const RunOptions& options) {
  return role == Role::mbd ? options.mbd_server : role == Role::dem ? options.dem_server : options.sph_server;
}

// Empty where the file can be executed; otherwise why not.
std::string problem_of(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) return "does not exist";
  if (error) return "cannot be read: " + error.message();
  if (status.type() == fs::file_type::directory) return "is a folder";
  if (access(file.c_str(), X_OK) != 0) return "is not executable";
  return {};
}

fs::path find_in_path(const std::string& name, const std::string& where) {
  const char* variable = std::getenv("PATH");
  const std::string folders = variable ? variable : "";
  for (std::size_t begin = 0; begin <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    const fs::path file = fs::absolute(fs::path(folders.substr(begin, end - begin)) / name);
    if (problem_of(file).empty()) return file;
    begin = end + 1;
  }
  throw Error(
      ErrorCode::usage, fmt::format("no folder of PATH has a program '{}'", printable(shortened(name))),
      where,
      fmt::format("install it, or give its path; ./{} is one in this folder", printable(shortened(name))));
}

}  // namespace

ServerCommand find_server(const std::string& command, const fs::path& folder, const std::string& where) {
  std::vector<std::string> words = split_command(command, where);
  const std::string name = words.front();
  words.erase(words.begin());
  if (name.find('/') == std::string::npos) return {command, find_in_path(name, where), words};
  const fs::path file = fs::absolute(folder / name).lexically_normal();
  if (const std::string problem = problem_of(file); !problem.empty())
    throw Error(ErrorCode::usage, fmt::format("program {} {}", printable(file.string()), problem), where,
                problem == "is not executable" ? "chmod +x makes it executable"
                                               : "give the path of a program, or the name of one in PATH");
  return {command, file, words};
}

std::string server_of_scene(Role role, const scene::Scene& scene) {
  std::string server;
  if (role == Role::mbd && scene.mbd) server = scene.mbd->server;
  if (role == Role::dem && scene.dem) server = scene.dem->server;
  if (role == Role::sph && scene.sph) server = scene.sph->server;
  return server == protocol::name(role) ? "" : server;
}

Command start_of(const ServerCommand& server, Role role, const std::vector<std::string>& arguments) {
  Command command;
  command.name = fmt::format("{} '{}'", protocol::name(role), printable(shortened(server.text)));
  command.program = server.program;
  command.arguments = server.arguments;
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.foreign = true;
  command.python = data_folder() / "python";
  return command;
}

std::optional<ServerCommand> foreign_server(Role role, const SceneFile& file, const RunOptions& options) {
  const Names names = names_of(role);
  const std::optional<std::string>& given = option_of(role, options);
  const std::string of_scene = server_of_scene(role, file.scene);
  if (given && !has_part(role, file.scene))
    throw Error(ErrorCode::usage, fmt::format("the scene has no {}, so that no such server runs", names.part),
                names.option, "leave the option out");
  if (given == protocol::name(role) || (!given && of_scene.empty())) return {};

  const std::string place = file.origin + ": " + names.key;
  const std::string where = given ? names.option : place;
  const std::string command = printable(shortened(given.value_or(of_scene)));
  for (const Role other : protocol::all_roles)
    if (given.value_or(of_scene) == protocol::name(other))
      throw Error(ErrorCode::usage,
                  fmt::format("'{}' computes the {}, and the server of the {} is wanted here", command,
                              names_of(other).part, names.part),
                  where,
                  fmt::format("leave it out for {}; {} is for the other one", protocol::name(role),
                              names_of(other).option));
  if (options.transport == Transport::inproc)
    throw Error(
        ErrorCode::usage,
        fmt::format("'{}' is a program, and --transport inproc runs the solvers inside this one", command),
        where, "leave --transport out");
  if (options.attach) {
    if (given)
      throw Error(ErrorCode::usage,
                  fmt::format("'{}' would be started here, and with --attach you start the servers yourself",
                              command),
                  where, "leave one of the two out");
    return {};
  }
  if (given) return find_server(*given, ".", where);
  // Nobody can trust what is not shown whole.
  constexpr std::size_t longest_shown = 1000;
  if (of_scene.size() > longest_shown)
    throw Error(ErrorCode::scene, fmt::format("is a command of {} bytes", of_scene.size()), where,
                fmt::format("write at most {}: call a script", longest_shown));
  if (!options.allow_scene_servers)
    throw Error(
        ErrorCode::usage,
        fmt::format("the scene would start the program '{}' on this computer, as you",
                    printable_line(of_scene)),
        where,
        fmt::format("if you trust it, add --allow-scene-servers; {} {} takes the server of tandem instead",
                    names.option, protocol::name(role)));
  return find_server(of_scene, fs::path(file.origin).parent_path(), where);
}

ForeignServers foreign_servers(const SceneFile& file, const RunOptions& options) {
  ForeignServers foreign;
  for (const Role role : protocol::all_roles) foreign.set(role, foreign_server(role, file, options));
  return foreign;
}

}  // namespace tandem::launch
