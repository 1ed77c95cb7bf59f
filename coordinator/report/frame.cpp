#include "coordinator/report/frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.hpp"
#include "coordinator/results/series/hdf5.hpp"

namespace tandem::launch {
namespace {

using Scale = ColourField::Scale;
constexpr std::array<ColourField, 9> fields{{{"speed", "m/s", Scale::from_zero},
                                             {"radius", "m", Scale::whole},
                                             {"spin", "rad/s", Scale::from_zero},
                                             {"group", "", Scale::named},
                                             {"material", "", Scale::named},
                                             {"contact_count", "", Scale::from_zero},
                                             {"mean_stress", "Pa", Scale::from_zero},
                                             {"pressure", "Pa", Scale::whole},
                                             {"density", "kg/m3", Scale::whole}}};

// The series with spheres: of grains and of the liquid.
constexpr std::array sphere_files{"particles.h5", "liquid.h5"};

// The groups of one file that are frames, ascending.
std::vector<std::string> groups_of(const std::filesystem::path& path) {
  std::vector<std::string> names = Hdf5File::open(path).children("/");
  std::erase_if(names, [](const std::string& name) { return !name.starts_with("frame_"); });
  return names;
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw Error(
      ErrorCode::resource, problem, path.string(),
      "the file, or that of the frame in the folder frames, is damaged, or was not written by this run");
}

// Refuses values that are not finite: the renderer would draw something arbitrary.
std::vector<double> read_finite(const Hdf5File& file, const std::string& dataset) {
  std::vector<double> numbers = file.read_doubles(dataset);
  for (const double number : numbers)
    if (!std::isfinite(number)) fail(file.path(), dataset + " has a value that is not a finite number");
  return numbers;
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

// One number for each sphere, of vectors their length.
std::vector<double> values_of(const Hdf5File& file, const std::string& dataset, std::size_t spheres) {
  std::vector<double> read = read_finite(file, dataset);
  if (spheres == 0 || read.size() != 3 * spheres) return read;
  std::vector<double> length(spheres);
  for (std::size_t i = 0; i < spheres; ++i)
    length[i] = norm(Vec3d{read[3 * i], read[3 * i + 1], read[3 * i + 2]});
  return length;
}

// Adds the spheres of one file that have the field; false where they have none.
bool add_spheres(const std::filesystem::path& path, const std::string& group, const ColourField& field,
                 Frame& frame) {
  const Hdf5File file = Hdf5File::open(path);
  const std::string dataset = "/" + group + "/" + field.name;
  frame.time = file.number_attribute("/" + group, "time");
  if (!file.has(dataset)) {
    if (!file.has("/" + group + "/radius")) fail(path, group + " lacks its spheres");
    return false;
  }
  const std::vector<double> position = read_finite(file, "/" + group + "/position"),
                            radius = read_finite(file, "/" + group + "/radius");
  const std::size_t spheres = radius.size();
  const std::vector<double> value = values_of(file, dataset, spheres);
  if (position.size() != 3 * spheres || value.size() != spheres)
    fail(path, group + " has " + std::to_string(spheres) + " radii, " + std::to_string(position.size()) +
                   " coordinates and " + std::to_string(value.size()) + " values of " + field.name);
  frame.position.insert(frame.position.end(), position.begin(), position.end());
  frame.radius.insert(frame.radius.end(), radius.begin(), radius.end());
  frame.value.insert(frame.value.end(), value.begin(), value.end());
  return true;
}

void read_particles(const std::filesystem::path& folder, const std::string& group, const ColourField& field,
                    Frame& frame) {
  const char* without = nullptr;
  bool found = false;
  for (const char* file : sphere_files) {
    if (!exists(folder / file)) continue;
    const std::size_t before = frame.radius.size();
    if (add_spheres(folder / file, group, field, frame))
      found = true;
    else
      without = file;
    if (file == sphere_files.back()) frame.liquid = frame.radius.size() - before;
  }
  if (without && !found)
    throw Error(ErrorCode::usage, std::string("the frames of this run have no '") + field.name + "'",
                (folder / without).string(),
                std::string("\"output\": {\"fields\": [\"") + field.name + "\"]} of the scene puts it there");
}

void read_surfaces(const std::filesystem::path& path, const std::string& group, Frame& frame) {
  const Hdf5File file = Hdf5File::open(path);
  frame.time = file.number_attribute("/" + group, "time");
  for (const std::string& body : file.children("/bodies")) {
    const std::string moved = "/" + group + "/" + body;
    const bool moves = file.has(moved);
    const std::vector<std::uint32_t> corners = file.read_indices("/bodies/" + body + "/triangles");
    const std::vector<double> vertices = read_finite(file, "/bodies/" + body + "/vertices");
    Surface& surface = frame.surfaces.emplace_back(
        Surface{body, !moves, mesh_of(moves ? read_finite(file, moved) : vertices, corners, path, body)});
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

const ColourField& colour_field(const std::string& name) {
  for (const ColourField& field : fields)
    if (name == field.name) return field;
  std::string known;
  for (const ColourField& field : fields) known += (known.empty() ? "" : ", ") + std::string(field.name);
  throw Error(ErrorCode::usage, "spheres have no '" + name + "'", "--colour-by", "it is one of " + known);
}

std::vector<std::string> frame_names(const std::filesystem::path& folder) {
  std::optional<std::vector<std::string>> names;
  for (const char* file : {sphere_files[0], sphere_files[1], "bodies.h5"}) {
    if (!exists(folder / file)) continue;
    const std::vector<std::string> of_file = groups_of(folder / file);
    if (names)
      std::erase_if(
          *names, [&](const std::string& name) { return std::ranges::find(of_file, name) == of_file.end(); });
    else
      names = of_file;
  }
  return names.value_or(std::vector<std::string>{});
}

Frame read_frame(const std::filesystem::path& folder, const std::string& name, const ColourField& field) {
  Frame frame;
  read_particles(folder, name, field, frame);
  if (exists(folder / "bodies.h5")) read_surfaces(folder / "bodies.h5", name, frame);
  return frame;
}

Frame read_last_frame(const std::filesystem::path& folder) {
  const std::vector<std::string> names = frame_names(folder);
  return names.empty() ? Frame{} : read_frame(folder, names.back(), fields[0]);
}

}  // namespace tandem::launch
