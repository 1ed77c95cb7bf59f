// The frames of a run, read back from its HDF5 files.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// Where a body is, from three points of its surface.
struct PlacedFrame {
  Vec3d from, to;                           // one point, in the body's frame and in the world [m]
  std::array<Vec3d, 3> axes_from, axes_to;  // the same directions in both
  Vec3d point(Vec3d p_B) const;
};

struct Surface {
  std::string name;                       // of the body
  bool fixed = false;                     // the ground's
  TriangleMesh mesh;                      // world [m]
  std::optional<PlacedFrame> frame = {};  // absent for the ground, and where all points are in a line
};

// What the colour of the spheres shows: a dataset of the frames, of vectors their length.
struct ColourField {
  enum class Scale { from_zero, whole, named };  // `named`: the value is an index in a list of the scene
  const char *name, *unit;
  Scale scale;
  std::string title() const { return *unit == '\0' ? name : std::string(name) + " [" + unit + "]"; }
};
// Throws Error{usage} for a name that is none of them.
const ColourField& colour_field(const std::string& name);

// The surface around the particles of a liquid.
struct LiquidSurface {
  TriangleMesh mesh;           // world [m]
  std::vector<Vec3d> normals;  // of the vertices, out of the liquid
  std::vector<double> value;   // of the vertices, as Frame::value
};

struct Frame {
  double time = 0;               // [s]
  std::vector<double> position;  // [m] (n x 3)
  std::vector<double> radius;    // [m] (n)
  std::vector<double> value;     // of the field that was asked for (n)
  std::size_t liquid = 0;        // so many of the spheres, the last ones, are particles of a liquid
  std::optional<LiquidSurface> liquid_surface;
  std::vector<Surface> surfaces;

  Vec3d centre(std::size_t i) const { return {position[3 * i], position[3 * i + 1], position[3 * i + 2]}; }
  bool has_particles() const { return !radius.empty() || liquid_surface; }
  bool empty() const { return position.empty() && surfaces.empty(); }
};

// `from` and `to`: the same points in the body's frame and in the world.
std::optional<PlacedFrame> placed_frame(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to);

// The frames of a run that are complete, in order ("frame_000012"). Throws Error{resource} for a file that
// cannot be read, as the functions below.
std::vector<std::string> frame_names(const std::filesystem::path& folder);
// Throws Error{usage} where the frame lacks the field.
Frame read_frame(const std::filesystem::path& folder, const std::string& name, const ColourField& field);
// Empty where the run has written no frame.
Frame read_last_frame(const std::filesystem::path& folder);

}  // namespace tandem::launch
