// Parts of a STEP file: what tandem_step, the program that OpenCASCADE is linked to, wrote about it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/mass_properties.hpp"
#include "common/geometry/triangle_mesh.hpp"

namespace tandem::launch {

// A cylindrical or plane face of a product, in its frame.
struct StepFace {
  bool is_plane = false;
  Vec3d point;                       // of the plane, or of the axis [m]
  Vec3d direction;                   // normal out of the solid, or axis
  double radius = 0;                 // [m]
  bool is_hole = false;              // the solid is outside the cylinder
  double begin = 0, end = 0;         // along the axis from `point` [m]
  double angle = 0;                  // that the face covers around the axis [rad]
  double area = 0;                   // of a plane face [m2]
  std::size_t first = 0, count = 0;  // its triangles in the mesh of the product
};

// A shape with all its instances.
struct StepProduct {
  std::string name;
  MassProperties unit;                         // of density 1 kg/m3; mass 0: no solid
  Vec3d low, high;                             // bounding box [m]
  double deviation = 0, stated_deviation = 0;  // of the mesh from the surface: measured, and its limit [m]
  TriangleMesh mesh;                           // [m]
  std::vector<StepFace> faces;

  double size() const { return norm(high - low); }  // [m]
};

struct StepPart {
  std::vector<std::string> path;  // names of the assemblies from the outermost one, then that of the part
  std::size_t product = 0;
  Pose pose;                                    // of the product's frame in the world
  std::optional<std::array<double, 3>> colour;  // red, green, blue from 0 to 1
  std::string material;                         // as the file calls it; may be empty

  const std::string& name() const { return path.back(); }
};

struct StepFile {
  std::string unit;        // of lengths in the file
  std::size_t faults = 0;  // entities that OpenCASCADE could not read
  std::string first_fault;
  std::vector<StepProduct> products;
  std::vector<StepPart> parts;  // in the order of the file
};

// deviation: of the meshes [m]; absent: 1/1000 of the diagonal of each product. Throws Error{scene} where the
// file cannot be read within 8 GiB and 10 minutes, and Error{usage} where this build reads no STEP files.
StepFile read_step(const std::filesystem::path& file, std::optional<double> deviation);

}  // namespace tandem::launch
