#include "coordinator/scene/contact_sizes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "common/scene/shape_mesh.hpp"

namespace tandem::launch {
namespace {

// A part may be this much wider than the rest of the machine, ground under it from a file, ground of which
// the scene itself gives the size, and anything at all. Ground in mm that is as wide as the machine is a
// thousand times too wide, and that of a vehicle may be a map of some km.
constexpr double wide_part = 100, wide_file = 2000, wide_ground = 1e5,
                 wide_anything = 1e6;  // [-] [-] [-] [m]

struct Sized {
  const scene::Shape* shape;
  bool of_ground;
  double width;  // [m]
};

double width_of(const TriangleMesh& mesh) {
  double width = 0;
  for (int a = 0; a < 3; ++a) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3d& vertex : mesh.vertices) {
      low = std::min(low, vertex[a]);
      high = std::max(high, vertex[a]);
    }
    width = std::max(width, high - low);
  }
  return width;
}

std::vector<Sized> sizes_of(const SceneFile& file) {
  std::vector<Sized> sizes;
  const auto add = [&](const scene::Shape& shape, BodyId body) {
    const auto drawn = std::ranges::find_if(
        file.drawn, [&](const BodyMesh& mesh) { return mesh.body == body && mesh.name == shape.name; });
    if (drawn != file.drawn.end()) sizes.push_back({&shape, body == ground, width_of(drawn->mesh)});
  };
  for (const scene::Shape& shape : file.scene.shapes)
    if (shape.use == scene::ShapeUse::contact) add(shape, shape.body);
  if (file.scene.contact)
    for (const scene::Shape& shape : file.scene.contact->ground) add(shape, ground);
  return sizes;
}

}  // namespace

std::optional<Unit> unit_that_fits(double width, double most) {
  for (const Unit unit : {Unit{"mm", 1e-3}, Unit{"micrometres", 1e-6}})
    if (width * unit.metres <= most) return unit;
  return {};
}

std::string question_of_scale(double width, double most, double scale) {
  const std::optional<Unit> unit = unit_that_fits(width, most);
  if (!unit) return "neither mm nor micrometres make it fit: check the file and its \"scale\"";
  return fmt::format("is the file in {}? then give \"scale\": {:.6g}", unit->name, unit->metres * scale);
}

namespace {

std::string question_of_size(double width, double most) {
  const std::optional<Unit> unit = unit_that_fits(width, most);
  if (!unit) return "neither mm nor micrometres make it fit: check its size";
  return fmt::format("is it in {}? then multiply it by {:.6g}", unit->name, unit->metres);
}

}  // namespace

void review_contact_sizes(const SceneFile& file, double machine, std::vector<std::string>& warnings) {
  const std::vector<Sized> sizes = sizes_of(file);
  for (const Sized& one : sizes) {
    double others = machine;
    for (const Sized& other : sizes)
      if (&other != &one && !other.of_ground) others = std::max(others, other.width);
    const std::string& name = scene::file_of(one.shape->geometry);
    const double factor = !one.of_ground ? wide_part : name.empty() ? wide_ground : wide_file;
    const double most = std::min(wide_anything, others > 0 ? factor * others : wide_anything);
    if (one.width <= most) continue;
    const std::string from = name.empty()
                                 ? ""
                                 : fmt::format(", by {} with a scale of {}", name,
                                               scene::scale_text(scene::scale_of(one.shape->geometry),
                                                                 scene::stretch_of(one.shape->geometry)));
    const std::string beside =
        others > 0 ? fmt::format(", and the rest of the machine {:.3g} m", others) : std::string();
    warnings.push_back(fmt::format(
        "shape \"{}\" of contact is {:.3g} m wide{}{}: {}", one.shape->name, one.width, from, beside,
        name.empty() ? question_of_size(one.width, most)
                     : question_of_scale(one.width, most, scene::scale_of(one.shape->geometry))));
  }
}

}  // namespace tandem::launch
