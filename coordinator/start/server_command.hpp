// A server other than mbd_server, dem_server and sph_server: the command that starts it, from the command
// line or from the scene.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/scene/options.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/start/processes.hpp"
#include "protocol/messages.hpp"

namespace tandem::launch {

struct ServerCommand {
  std::string text;               // as given
  std::filesystem::path program;  // absolute, an executable file
  std::vector<std::string> arguments;
};

// Finds the program: a path where the first word has a '/', which starts at `folder` if it is relative;
// otherwise a program of PATH. Throws Error at `where` where there is none that can be executed.
ServerCommand find_server(const std::string& command, const std::filesystem::path& folder,
                          const std::string& where);

// What starts that program as a participant of this role, with `arguments` after its own. It finds tandem's
// Python package, and is ended with its children.
Command start_of(const ServerCommand& server, protocol::Role role, const std::vector<std::string>& arguments);

// The command that replaces our server of this role in a run; none where our server runs. An option of the
// command line wins over the scene; the plain name of our server means ours. Throws Error{usage} where the
// command line does not allow it: the scene's command without --allow-scene-servers, one of the command line
// with
// --attach, and any with --transport inproc. With --attach the scene's command is not started.
std::optional<ServerCommand> foreign_server(protocol::Role role, const SceneFile& file,
                                            const RunOptions& options);

class ForeignServers {
 public:
  const std::optional<ServerCommand>& of(protocol::Role role) const { return commands_.at(place(role)); }
  void set(protocol::Role role, std::optional<ServerCommand> command) {
    commands_.at(place(role)) = std::move(command);
  }

 private:
  static std::size_t place(protocol::Role role) { return static_cast<std::size_t>(role) - 1; }
  std::array<std::optional<ServerCommand>, protocol::all_roles.size()> commands_;
};
ForeignServers foreign_servers(const SceneFile& file, const RunOptions& options);

// The command of the scene for this role; empty where it names none, or our server by its plain name.
std::string server_of_scene(protocol::Role role, const scene::Scene& scene);

}  // namespace tandem::launch
