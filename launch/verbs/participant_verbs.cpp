#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "common/seconds.hpp"
#include "common/utf8.hpp"
#include "launch/conform/conform.hpp"
#include "launch/keys/keys.hpp"
#include "launch/new_project/new_project.hpp"
#include "launch/replay/replay.hpp"
#include "launch/verbs/options.hpp"
#include "launch/verbs/python_module.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace {

std::map<std::string, protocol::Role> all_roles() {
  std::map<std::string, protocol::Role> roles;
  for (const protocol::Role role : protocol::all_roles) roles[protocol::word_of(role)] = role;
  return roles;
}

}  // namespace

void add_conform(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand(
      "conform", "Try whether a participant does what it claims, and name what it does otherwise");
  auto options = std::make_shared<conform::ConformOptions>();
  auto patience = std::make_shared<double>(10), answer = std::make_shared<double>(1);  // [s]
  auto list = std::make_shared<bool>(false);
  auto long_run = std::make_shared<double>(0);  // [s]
  const std::map<std::string, protocol::Role> roles = all_roles();
  const std::map<std::string, conform::Transport> transports{{"shm", conform::Transport::shm},
                                                             {"stream", conform::Transport::stream}};
  CLI::Option* command =
      verb->add_option("command", options->command,
                       "Program with its arguments, in one word; mbd_server, dem_server and sph_server are "
                       "those of this build");
  verb->add_option("--role", options->role, "Side that it takes")->required()->transform(one_of(roles));
  verb->add_option("--transport", options->transport, "How it is reached")
      ->transform(one_of(transports))
      ->default_str("shm");
  verb->add_option("--scene", options->scene,
                   "Judge on this scene, by the checks that hold on any, in place of the built-in ones")
      ->type_name("FILE");
  add_set(*verb, options->set);
  verb->add_option("--check", options->checks, "Only this check; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  verb->add_option("--out", options->out, "Folder for conform.json, conform.html and participant.log")
      ->type_name("DIR");
  verb->add_option("--patience", *patience, "Longest wait for an answer [s]")->capture_default_str();
  verb->add_option("--answer-limit", *answer, "Longest answer to a window of 1 ms that counts as in time [s]")
      ->capture_default_str();
  verb->add_option("--long", *long_run, "Also try a run of this simulated time, 2 s or more [s]");
  verb->add_flag("--list", *list, "List the checks of the role, and judge nothing");
  verb->callback([=, &status] {
    if (*list) {
      fmt::print("{}", conform::list_of_checks(options->role));
      return;
    }
    if (command->empty())
      throw Error(ErrorCode::usage, "no participant is given", "tandem conform",
                  "give the command that starts it, as in tandem conform ./my_solver --role mbd");
    if (!options->set.empty() && options->scene.empty())
      throw Error(ErrorCode::usage, "needs --scene", "--set", "the built-in scenes have no parameters");
    options->limits.patience = bounded_seconds(*patience, least_patience, most_patience, "--patience");
    options->limits.answer = bounded_seconds(*answer, least_patience, most_patience, "--answer-limit");
    if (*long_run != 0 && !(*long_run >= conform::shortest_long_run && *long_run <= 1e5))
      throw Error(ErrorCode::usage, fmt::format("{:g} s is no time of a long run", *long_run), "--long",
                  "give 2 to 100000 s of simulated time");
    options->limits.long_run = *long_run;
    status = conform::conform(*options);
  });
}

void add_replay(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand(
      "replay", "Repeat a recording against one solver, up to the first difference (docs/replay.md)");
  auto options = std::make_shared<ReplayOptions>();
  auto list = std::make_shared<bool>(false);
  auto patience = std::make_shared<double>(60);  // [s]
  const std::map<std::string, protocol::Role> roles = all_roles();
  verb->add_option("recording", options->recording,
                   "File of tandem run --record, or last_windows.rec of a failed run")
      ->required();
  CLI::Option* role = verb->add_option("--role", options->role, "Whose answers are compared: mbd, dem or sph")
                          ->transform(one_of(roles));
  verb->add_option("--server", options->server,
                   "Command of the server that is compared, with its arguments; without it the solver of "
                   "tandem, in this process")
      ->needs(role);
  const std::map<std::string, bool> transports{{"shm", false}, {"stream", true}};
  verb->add_option("--transport", options->stream,
                   "How that server is reached: shm, or stream, its standard input and output")
      ->transform(one_of(transports))
      ->default_str("shm")
      ->needs(role);
  verb->add_option("--patience", *patience, "Longest wait for an answer [s]")->capture_default_str();
  verb->add_flag("--list", *list, "Print a line for each frame, and replay nothing")->excludes(role);
  verb->callback([=, &status] {
    if (*list) return list_recording(options->recording);
    if (role->empty())
      throw Error(ErrorCode::usage, "needs --role mbd, --role dem, --role sph or --list", "tandem replay",
                  "--role names the solver whose answers are compared");
    options->patience = bounded_seconds(*patience, least_patience, most_patience, "--patience");
    status = replay(*options);
  });
}

void add_new(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("new",
                         "Make a project with a solver of your own (docs/participant.md), or a scene "
                         "from a template (docs/python.md)");
  auto kind = std::make_shared<std::string>(), scene_template = std::make_shared<std::string>();
  auto wanted = std::make_shared<NewParticipant>();
  verb->add_option("kind", *kind, "What to make: participant, or scene")->required();
  verb->add_option("name", wanted->name,
                   "Name of the project and of its program, or of the scene, which may be without one");
  verb->add_option("--language", wanted->language,
                   "Language of the solver: cpp, c, fortran, python; a participant needs it");
  verb->add_option(
          "--role", wanted->role,
          "Solver of the bodies (mbd), of spheres (dem) or of a liquid (sph); a participant needs it")
      ->check(CLI::IsMember({"mbd", "dem", "sph"}));
  verb->add_option(
      "--template", *scene_template,
      "Scene to start from: hopper, round_hopper, conveyor, screw, chute, tank, mixer, bucket or linkage");
  verb->add_option("--out", wanted->folder,
                   "New folder of a participant, new file of a scene; without it one with the name, here");
  verb->callback([=] {
    if (*kind == "scene") {
      if (scene_template->empty())
        throw Error(
            ErrorCode::usage, "is required", "--template",
            "write tandem new scene --template hopper, round_hopper, conveyor, screw, chute, tank, mixer, "
            "bucket or linkage");
      std::vector<std::string> words{"--template=" + *scene_template};
      if (!wanted->name.empty()) words.push_back(wanted->name);
      if (!wanted->folder.empty()) words.push_back("--out=" + wanted->folder.string());
      become_python("tandem.templates", words);
    }
    if (*kind != "participant")
      throw Error(ErrorCode::usage, "makes no '" + shortened(*kind) + "'", "tandem new",
                  "write tandem new participant NAME, or tandem new scene --template hopper");
    const std::pair<const char*, std::string> required[] = {
        {"name", wanted->name}, {"--language", wanted->language}, {"--role", wanted->role}};
    for (const auto& [option, value] : required)
      if (value.empty()) throw Error(ErrorCode::usage, "is required", option, "tandem new --help says more");
    new_participant(*wanted);
  });
}

void add_keys(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("keys", "Make what protects runs over a network (docs/security.md)");
  auto secret = std::make_shared<std::string>(), certificates = std::make_shared<std::string>();
  auto days = std::make_shared<int>(365);
  verb->add_option("--secret", *secret, "New file with a new secret")->type_name("FILE");
  CLI::Option* folder =
      verb->add_option("--certificates", *certificates, "New folder with new certificates")->type_name("DIR");
  verb->add_option("--days", *days, "How long the certificates are valid")
      ->check(CLI::Range(1, 3650))
      ->needs(folder)
      ->capture_default_str();
  verb->require_option(1, 3);
  verb->callback([=] {
    if (!secret->empty()) write_secret(*secret);
    if (!certificates->empty()) write_certificates(*certificates, *days);
  });
}

}  // namespace tandem::launch
