// Reads a scene, in steps that stand alone: parse() JSON text -> schema -> Scene with names resolved;
// validate() what a schema cannot express; validate_files() what lies beside the scene on the machine where
// it is started. Every error is an Error{ErrorCode::scene} whose where() is "FILE: path.inside[3].the.file",
// whose problem() gives the value, and whose hint() gives the nearest valid name or the remedy.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scene/model.hpp"

namespace tandem::scene {

// `origin` names the text in errors: the file's path.
Scene parse(const std::string& text, const std::string& origin);

// The published schema (draft 7), as built in.
const std::string& schema();

// Checks of a parsed scene that need no file: inertia is that of a real body, pairs complete, overlapping
// walls, domain holds the fills, window is a whole number of nanoseconds, micro step below the stable limit,
// zero spheres, ...
void validate(const Scene& scene, const std::string& origin);

// What a valid scene may do that its author may not have meant, in sentences that say where, how much and
// what to write instead: splines that leave their points, motions that run into a jump of their rate.
std::vector<std::string> warnings(const Scene& scene);

// Where a file named in a scene is: relative names start at the scene's folder.
std::filesystem::path resolve_file(const std::string& file, const std::filesystem::path& folder);

// Mesh and particle files exist in `folder` and particle files fit the scene. For the coordinator: a server
// gets a scene whose files travelled with it. The triangles of meshes are checked where they are imported.
void validate_files(const Scene& scene, const std::string& origin, const std::filesystem::path& folder);

}  // namespace tandem::scene
