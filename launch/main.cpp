// The command `tandem`: refuses unknown words and tells errors; the verbs are in launch/verbs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/error.hpp"
#include "common/interrupt.hpp"
#include "common/log.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/scene/parse.hpp"
#include "common/stack_limit.hpp"
#include "common/utf8.hpp"
#include "coordinator/start/build_info.hpp"
#include "launch/verbs/verbs.hpp"
#include "protocol/version.hpp"

namespace {

using namespace tandem;
using namespace tandem::launch;

std::string version_text() {
  return fmt::format(
      "tandem {}, protocol {}.{}\nback ends: cpu{}\ntransports: shm, inproc, stream{}\nimports: urdf{}",
      version, protocol::protocol_version.major, protocol::protocol_version.minor, has_cuda ? ", cuda" : "",
      has_dds ? ", dds" : "",
      has_step ? fmt::format(", step (OpenCASCADE {})", step_version)
               : "; no step, for lack of OpenCASCADE (launch/install --cad, then launch/build)");
}

// Throws Error{usage} for bytes that are not UTF-8: summary, log and messages could not contain them.
void expect_utf8(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (!is_utf8(word))
      throw Error(ErrorCode::usage, "is not UTF-8: \"" + printable(shortened(word)) + "\"", "command line",
                  "rename the file, or write the word in UTF-8");
}

// Names of all verbs, and the long options of one.
std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// Throws Error{usage} with the unknown verb or option and the nearest one; the parser would name neither.
void expect_known_words(const CLI::App& app, const std::vector<std::string>& words) {
  const std::vector<std::string> verbs = verbs_of(app);
  const auto knows = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (words.empty())
    throw Error(ErrorCode::usage, "no verb is given", {},
                suggest_name("", verbs, "verbs") + "; tandem --help says more");
  if (words.front().starts_with('-')) return;
  if (!knows(verbs, words.front()))
    throw Error(ErrorCode::usage, "tandem has no verb '" + shortened(words.front()) + "'", {},
                suggest_name(words.front(), verbs, "verbs"));
  const std::vector<std::string> options = options_of(*app.get_subcommand(words.front()));
  for (const std::string& word : words) {
    if (word == "--") return;
    const std::string option = word.substr(0, word.find('='));
    if (option.starts_with("--") && !knows(options, option))
      throw Error(ErrorCode::usage, "tandem " + words.front() + " has no option '" + shortened(option) + "'",
                  {}, suggest_name(option, options, "options"));
  }
}

}  // namespace

int main(int argc, char** argv) {
  int status = 0;
  CLI::App app("Co-simulation of multibody machines with very many particles");
  app.name("tandem");
  app.require_subcommand(1);
  app.set_version_flag("--version", version_text());
  add_run(app, status);
  add_validate(app, status);
  add_describe(app);
  add_plan(app);
  add_preview(app);
  add_movie(app);
  add_modes(app);
  add_study(app, status);
  add_sweep(app);
  add_soften(app);
  add_import(app);
  add_mesh(app, status);
  add_ps(app);
  add_stop(app);
  add_keys(app);
  add_conform(app, status);
  add_replay(app, status);
  add_new(app);
  app.add_subcommand("schema", "Print the JSON schema of scenes")->callback([] {
    fmt::print("{}\n", scene::schema());
  });

  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    end_on_interrupt();
    expect_stack();
    expect_open_files();
    log::setup("tandem");
    expect_utf8(words);
    expect_known_words(app, words);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    fmt::print(stderr, "error: {}\nRun with --help for more information.\n",
               printable(with_short_words(error.what(), words)));
    return exit_status(ErrorCode::usage);
  } catch (const Error& error) {
    fmt::print(stderr, "error: {}\n", printable(with_short_words(error.what(), words)));
    return exit_status(error.code());
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {} (a bug of tandem: please report it)\n", error.what());
    return exit_status(ErrorCode::internal);
  }
  return status;
}
