#include "launch/conform/conform.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "common/log.hpp"
#include "common/scene/nearest_name.hpp"
#include "coordinator/run_folder/claimed_folder.hpp"
#include "coordinator/scene/scene_file.hpp"
#include "coordinator/start/processes.hpp"
#include "coordinator/start/server_command.hpp"
#include "launch/conform/judge.hpp"
#include "launch/conform/report.hpp"
#include "protocol/fd.hpp"

namespace tandem::conform {
namespace {

launch::ServerCommand command_of_participant(const ConformOptions& options) {
  for (const protocol::Role role : protocol::all_roles)
    if (const std::string own = protocol::name(role); options.command == own)
      return {own, launch::program_folder() / own, {}};
  return launch::find_server(options.command, ".", "the participant");
}

JudgedScene scene_of_user(const std::filesystem::path& path, const std::map<std::string, double>& set,
                          protocol::Role role) {
  launch::Overrides overrides;
  overrides.set = set;
  launch::SceneFile file = launch::read_scene(path, overrides);
  const bool there = role == protocol::Role::mbd   ? file.scene.mbd.has_value()
                     : role == protocol::Role::dem ? file.scene.dem.has_value()
                                                   : file.scene.sph.has_value();
  const char* part = role == protocol::Role::mbd   ? "bodies (mbd)"
                     : role == protocol::Role::dem ? "particles (dem)"
                                                   : "liquid (sph)";
  if (!there)
    throw Error(ErrorCode::usage, fmt::format("has no {} for the participant to compute", part),
                path.string(), "give a scene that has");
  protocol::Configuration configuration{file.text, file.origin, file.meshes, file.files, "auto", 1};
  return {std::move(configuration), std::move(file.scene)};
}

void expect_known(const std::vector<std::string>& wanted, protocol::Role role) {
  std::vector<std::string> names;
  for (const Check& check : checks())
    if (check.of(role)) names.emplace_back(check.name);
  for (const std::string& name : wanted)
    if (std::ranges::find(names, name) == names.end())
      throw Error(ErrorCode::usage, "there is no check '" + name + "' for this role", "--check",
                  suggest_name(name, names, "checks"));
}

}  // namespace

int conform(const ConformOptions& options) {
  expect_known(options.checks, options.role);
  const launch::ServerCommand command = command_of_participant(options);
  std::optional<JudgedScene> scene;
  if (!options.scene.empty()) scene = scene_of_user(options.scene, options.set, options.role);
  // Without a folder what it writes is kept in memory, for the last words of one that ends.
  const protocol::Fd unnamed(memfd_create("participant.log", MFD_CLOEXEC));
  std::filesystem::path log =
      unnamed ? fmt::format("/proc/{}/fd/{}", getpid(), unnamed.get()) : std::string("/dev/null");
  if (!options.out.empty()) {
    launch::claim_folder(options.out,
                         {"conform",
                          {"conform.json", "conform.html", "participant.log"},
                          {options.scene.empty() ? command.program : options.scene, command.program}});
    log = std::filesystem::absolute(options.out / "participant.log");
    replace_file(log, "");
  }
  log::quiet();  // refusals are what most of these runs end with
  const auto subject = make_subject(options.role, command, options.transport, log);
  const Judgement judgement =
      judge(*subject, options.limits, scene, options.checks, [](const Result& result) {
        fmt::print("{}", row(result));
        std::fflush(stdout);
      });
  fmt::print("{}", last_line(judgement));
  if (judgement.program.empty() && options.out.empty())
    fmt::print("with --out DIR, what it wrote to its standard error is in DIR/participant.log\n");
  if (!options.out.empty()) {
    replace_file(options.out / "conform.json", to_json(judgement).dump(2) + '\n');
    replace_file(options.out / "conform.html", page(judgement));
  }
  return judgement.passed() ? 0 : 1;
}

std::string list_of_checks(protocol::Role role) {
  std::string text;
  for (const Check& check : checks())
    if (check.of(role)) text += fmt::format("{:<25} {}\n", check.name, check.meaning);
  return text;
}

}  // namespace tandem::conform
