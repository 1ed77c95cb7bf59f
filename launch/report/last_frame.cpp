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
    const std::vector<std::uint32_t> corners = file.read_indices("/bodies/" + body + "/triangles");
    const std::vector<double> vertices = file.read_doubles("/bodies/" + body + "/vertices");
    Surface& surface = frame.surfaces.emplace_back(
        Surface{body, !moves, mesh_of(moves ? file.read_doubles(moved) : vertices, corners, path, body)});
    if (moves)
      surface.frame = placed_frame(mesh_of(vertices, corners, path, body).vertices, surface.mesh.vertices);
  }
}

}  // namespace

Vec3d PlacedFrame::point(Vec3d p_B) const {
  Vec3d p = to;
  for (std::size_t k = 0; k < 3; ++k) p += dot(p_B - from, axes_from[k]) * axes_to[k];
  return p;
}

std::optional<PlacedFrame> placed_frame(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
  if (from.size() < 3 || from.size() != to.size()) return {};
  // The farthest point from the first, and the one farthest from the line between them.
  std::size_t b = 0, c = 0;
  for (std::size_t i = 1; i < from.size(); ++i)
    if (norm2(from[i] - from[0]) > norm2(from[b] - from[0])) b = i;
  const auto area = [&](std::size_t i) { return norm2(cross(from[b] - from[0], from[i] - from[0])); };
  for (std::size_t i = 1; i < from.size(); ++i)
    if (area(i) > area(c)) c = i;
  if (!(area(c) > 0)) return {};
  const auto axes = [&](const std::vector<Vec3d>& points) {
    const Vec3d x = normalized(points[b] - points[0]),
                z = normalized(cross(points[b] - points[0], points[c] - points[0]));
    return std::array<Vec3d, 3>{x, cross(z, x), z};
  };
  return PlacedFrame{from[0], to[0], axes(from), axes(to)};
}

LastFrame read_last_frame(const std::filesystem::path& folder) {
  LastFrame frame;
  if (exists(folder / "particles.h5")) read_particles(folder / "particles.h5", frame);
  if (exists(folder / "bodies.h5")) read_surfaces(folder / "bodies.h5", frame);
  return frame;
}

}  // namespace tandem::launch
