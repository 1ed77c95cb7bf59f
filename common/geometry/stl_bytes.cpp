#include "common/geometry/stl_bytes.hpp"

#include <array>

namespace tandem {

std::string stl_bytes(const TriangleMesh& mesh) {
  // 80 bytes of text, the number of triangles, 50 bytes for each (coordinator/mesh_import/stl_file.hpp).
  std::string bytes(80, ' ');
  bytes.reserve(84 + 50 * mesh.triangles.size());
  const auto put = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d a = mesh.vertices[i], b = mesh.vertices[j], c = mesh.vertices[k];
    const Vec3d area = cross(b - a, c - a);
    for (const Vec3d& v : {(1 / norm(area)) * area, a, b, c})
      for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(v[axis]));
    put(std::uint16_t{0});
  }
  return bytes;
}

}  // namespace tandem
