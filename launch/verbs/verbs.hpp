// The verbs of the command `tandem`: each function adds one with its options to the parser, which calls what
// it does. `status` becomes the exit status.
#pragma once

#include <CLI/App.hpp>

namespace tandem::launch {

// Of scenes.
void add_run(CLI::App& app, int& status);
void add_study(CLI::App& app, int& status);
void add_sweep(CLI::App& app);
void add_soften(CLI::App& app);
void add_validate(CLI::App& app, int& status);
void add_describe(CLI::App& app);
void add_plan(CLI::App& app);
void add_preview(CLI::App& app);
void add_modes(CLI::App& app);
void add_import(CLI::App& app);
void add_mesh(CLI::App& app, int& status);

// Of runs and their results.
void add_movie(CLI::App& app);
void add_ps(CLI::App& app);
void add_stop(CLI::App& app);

// For participants and networks.
void add_conform(CLI::App& app, int& status);
void add_replay(CLI::App& app, int& status);
void add_new(CLI::App& app);
void add_keys(CLI::App& app);

}  // namespace tandem::launch
