#include "launch/import/model_format.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "common/error.hpp"
#include "common/input_file.hpp"

namespace tandem::launch {
namespace {

// The first bytes, without white space in front.
std::string beginning_of(const std::filesystem::path& file) {
  std::string bytes(1024, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);
  bytes.erase(0, std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  return bytes;
}

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

}  // namespace

ModelFormat format_of(const std::filesystem::path& file) {
  expect_input(file, {.largest = largest_mesh, .hint = "give a STEP file or a URDF file"});
  const std::string begin = beginning_of(file), ending = ending_of(file);
  const auto fail = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorCode::scene, problem, file.string(), hint);
  };
  // The header of STEP [ISO10303-21].
  if (begin.starts_with("ISO-10303-21")) return ModelFormat::step;
  if (begin.starts_with('<')) return ModelFormat::urdf;
  // Each line of IGES is 80 characters long, and has the letter of its section, first S, in column 73.
  const bool is_iges = begin.size() > 72 && begin[72] == 'S' && begin.find('\n') > 72;
  if (is_iges || ending == ".igs" || ending == ".iges")
    fail("is IGES, which has surfaces and no assemblies, and is not read",
         "export STEP (AP214 or AP242) instead");
  if (ending == ".stl" || ending == ".obj")
    fail("is a mesh, not a machine",
         "name it in a scene as a shape or a wall: {\"type\": \"mesh\", \"file\": \"" +
             file.filename().string() + "\"}");
  if (ending == ".urdf" || ending == ".xml") return ModelFormat::urdf;  // urdfdom says what is wrong
  if (ending == ".step" || ending == ".stp")
    fail(begin.empty() ? "is empty" : "is no STEP file: it does not begin with ISO-10303-21",
         "export it again, as AP203, AP214 or AP242");
  fail("is neither STEP, which begins with ISO-10303-21, nor URDF, which begins with <",
       "tandem import reads these two; meshes (STL, OBJ) are named in a scene");
  return ModelFormat::urdf;  // not reached
}

}  // namespace tandem::launch
