// Reads a scene, in independent steps: parse() JSON text -> schema -> Scene with names resolved; validate()
// checks what a schema cannot express; validate_files() checks the files of the scene on the machine where it
// is started. Every error is an Error{ErrorCode::scene} whose where() is "FILE: path.inside[3].the.file",
// whose problem() gives the value, and whose hint() gives the nearest valid name or the remedy.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "common/scene/schema.hpp"

namespace tandem::scene {

// `origin` names the text in errors: the file's path.
Scene parse(const std::string& text, const std::string& origin);

// Checks of a parsed scene that need no file: inertia is possible for a real body, pairs are complete, walls
// do not overlap, the domain contains the fills, the window is a whole number of nanoseconds, the micro step
// is below the stable limit, ...
void validate(const Scene& scene, const std::string& origin);

// Properties of a valid scene that its author may not have intended, in sentences that say where, how much
// and what to write instead: splines that overshoot, motions that end in a jump of their rate.
std::vector<std::string> warnings(const Scene& scene);

// The path of a file named in a scene: relative names start at the scene's folder.
std::filesystem::path resolve_file(const std::string& file, const std::filesystem::path& folder);

// Checks that mesh and particle files exist in `folder` and that particle files fit the scene. For the
// coordinator only: a server receives a scene together with its files. Meshes are checked at their import.
void validate_files(const Scene& scene, const std::string& origin, const std::filesystem::path& folder);

}  // namespace tandem::scene
