#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "common/error.hpp"
#include "common/file_draft.hpp"
#include "common/geometry/coarse_mesh.hpp"
#include "common/geometry/stl_bytes.hpp"
#include "common/utf8.hpp"
#include "coordinator/mesh_import/mesh_import.hpp"
#include "coordinator/mesh_import/raw_mesh.hpp"
#include "launch/mesh_tools/mesh_check.hpp"
#include "launch/mesh_tools/mesh_repair.hpp"
#include "launch/verbs/verbs.hpp"

namespace tandem::launch {
namespace mesh_verbs {

struct MeshOptions {
  std::string action;
  std::filesystem::path file, output;
  double scale = 1;
  std::optional<double> deviation;
  RepairOptions repair;
};

std::string positive_length(const std::string& text) {
  double value = 0;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
             ? std::string()
             : "'" + shortened(text) + "' is not a finite number > 0";
}

// A volume needs a closed surface. A share of one that is round-off says nothing.
std::string change_of_volume(const MeshFacts& before, const MeshFacts& after) {
  if (!after.volume) return "no volume: the surface is not closed";
  if (!before.volume)
    return fmt::format("{:.9g} m3, none before: the surface was not closed, or wound both ways",
                       *after.volume);
  const std::string both = fmt::format("{:.9g} m3, {:.9g} m3 before", *after.volume, *before.volume);
  if (*before.volume < 1e-9 * before.area * before.diagonal()) return both;
  return fmt::format("{} ({:+.3g} of it)", both, (*after.volume - *before.volume) / *before.volume);
}

void write(const MeshOptions& options, const TriangleMesh& before, const TriangleMesh& after,
           double deviation) {
  if (after.triangles.empty())
    throw Error(ErrorCode::scene, "no triangle is left", options.file.string(), "export the mesh again");
  // Corners of single precision, as the file has them.
  TriangleMesh rounded = after;
  for (Vec3d& v : rounded.vertices)
    v = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  if (!degenerate_triangles(rounded).empty())
    throw Error(ErrorCode::scene,
                "the result has triangles without area in the single precision of an STL file",
                options.file.string(), "give a larger --weld or --deviation, or move the mesh to its origin");
  replace_file(options.output, stl_bytes(rounded));
  fmt::print("  {:<24} {}, {} before\n", "triangles", after.triangles.size(), before.triangles.size());
  fmt::print("  {:<24} {:.3g}\n", "moved by at most [m]", deviation);
  fmt::print("  {:<24} {}\n", "volume", change_of_volume(facts_of(before), facts_of(after)));
}

void require_output(const MeshOptions& options) {
  if (options.output.empty())
    throw Error(ErrorCode::usage, "mesh " + options.action + " needs -o", options.file.string(),
                "give the STL file to write, as in -o better.stl");
  if (options.output.extension() != ".stl")
    throw Error(ErrorCode::usage, "is no name of an STL file", options.output.string(),
                "give one that ends in .stl");
}

// 1 where faults are left, other than openings that --fill left, or parts that nobody can judge.
int repair(const MeshOptions& options) {
  require_output(options);
  const TriangleMesh mesh = read_raw_mesh(options.file, options.scale);
  const RepairedMesh result = repaired(mesh, options.repair);
  fmt::print("{} -> {}\n", options.file.string(), options.output.string());
  for (const std::string& done : result.done) fmt::print("  {}\n", done);
  if (result.done.empty()) fmt::print("  nothing to repair\n");
  write(options, mesh, result.mesh, result.deviation);
  const MeshFaults left = faults_of(result.mesh);
  for (const std::string& unclear : result.unclear) fmt::print("  {}\n", unclear);
  if (left.is_sound() && result.unclear.empty()) return 0;
  fmt::print("what is left:\n{}", report_of(left, options.output.string()));
  return options.repair.fill && left.is_sound_but_open() && result.unclear.empty() ? 0 : 1;
}

void coarsen(const MeshOptions& options) {
  require_output(options);
  if (!options.deviation)
    throw Error(ErrorCode::usage, "mesh coarsen needs --deviation", options.file.string(),
                "give the largest distance that the surface may move [m]; a hundredth of the smallest radius "
                "is little");
  const TriangleMesh mesh = import_mesh(options.file, options.scale);
  const CoarseMesh result = coarsened(mesh, *options.deviation);
  fmt::print("{} -> {}\n", options.file.string(), options.output.string());
  write(options, mesh, result.mesh, result.deviation);
}

}  // namespace mesh_verbs

void add_mesh(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand("mesh", "Check, repair or coarsen a triangle mesh");
  auto options = std::make_shared<mesh_verbs::MeshOptions>();
  verb->add_option("action", options->action, "check, repair or coarsen")
      ->required()
      ->check(CLI::IsMember({"check", "repair", "coarsen"}));
  verb->add_option("file", options->file, "STL or OBJ file")->required();
  verb->add_option("-o,--output", options->output, "STL file to write, in metres");
  verb->add_option("--scale", options->scale, "Metres per unit of the file")
      ->check(mesh_verbs::positive_length)
      ->capture_default_str();
  verb->add_option("--deviation", options->deviation,
                   "coarsen: largest distance that the surface may move [m]")
      ->check(mesh_verbs::positive_length);
  verb->add_option("--weld", options->repair.weld,
                   "repair: corners this near become one [m]; without it 1e-5 of the diagonal")
      ->check(mesh_verbs::positive_length);
  verb->add_option("--fill", options->repair.fill,
                   "repair: fill openings up to this width [m]; without it all")
      ->check(mesh_verbs::positive_length);
  verb->callback([=, &status] {
    if (options->action == "repair") {
      status = mesh_verbs::repair(*options);
      return;
    }
    if (options->action == "coarsen") return mesh_verbs::coarsen(*options);
    const MeshFaults faults = faults_of(read_raw_mesh(options->file, options->scale));
    fmt::print("{}", report_of(faults, options->file.string()));
    if (!faults.is_sound()) status = 1;
  });
}

}  // namespace tandem::launch
