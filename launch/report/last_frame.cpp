#include "launch/report/last_frame.hpp"

#include "common/error.hpp"
#include "launch/results/series/hdf5.hpp"

namespace tandem::launch {
namespace {

// "frame_000012", or an empty text.
std::string last_group(const Hdf5File& file) {
  std::string last;
  for (const std::string& name : file.children("/")) {
    if (name.starts_with("frame_")) last = name;  // children are listed in ascending order
  }
  return last;
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw Error(ErrorCode::resource, problem, path.string(),
              "the file is damaged, or was not written by this run");
}

TriangleMesh mesh_of(const std::vector<double>& vertices, const std::vector<std::uint32_t>& corners,
                     const std::filesystem::path& path, const std::string& body) {
  for (const std::uint32_t corner : corners)
    if (corner >= vertices.size() / 3)
      fail(path, "a triangle of body '" + body + "' has the vertex " + std::to_string(corner) + " of " +
                     std::to_string(vertices.size() / 3));
  TriangleMesh mesh;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    mesh.vertices.push_back({vertices[i], vertices[i + 1], vertices[i + 2]});
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  }
  return mesh;
}

void read_particles(const std::filesystem::path& path, LastFrame& frame) {
  const Hdf5File file = Hdf5File::open(path);
  const std::string group = last_group(file);
  if (group.empty()) return;
  frame.position = file.read_doubles("/" + group + "/position");
  frame.radius = file.read_doubles("/" + group + "/radius");
  frame.speed = file.read_doubles("/" + group + "/speed");
  const std::size_t spheres = frame.radius.size();
  if (frame.position.size() != 3 * spheres || frame.speed.size() != spheres)
    fail(path, group + " has " + std::to_string(spheres) + " radii, " +
                   std::to_string(frame.position.size()) + " coordinates and " +
                   std::to_string(frame.speed.size()) + " speeds");
}

void read_surfaces(const std::filesystem::path& path, LastFrame& frame) {
  const Hdf5File file = Hdf5File::open(path);
  const std::string group = last_group(file);
  if (group.empty()) return;
  for (const std::string& body : file.children("/bodies")) {
    const std::string moved = "/" + group + "/" + body;
    const bool moves = file.has(moved);
    frame.surfaces.push_back({body, !moves,
                              mesh_of(file.read_doubles(moves ? moved : "/bodies/" + body + "/vertices"),
                                      file.read_indices("/bodies/" + body + "/triangles"), path, body)});
  }
}

}  // namespace

LastFrame read_last_frame(const std::filesystem::path& folder) {
  LastFrame frame;
  if (exists(folder / "particles.h5")) read_particles(folder / "particles.h5", frame);
  if (exists(folder / "bodies.h5")) read_surfaces(folder / "bodies.h5", frame);
  return frame;
}

}  // namespace tandem::launch
