#include "common/geometry/solid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tandem {

namespace {

// A ring of n vertices about the z axis; a radius of 0 is a single vertex on the axis.
struct Ring {
  std::uint32_t first = 0;
  bool point = false;
};

// Adds rings from bottom to top, and closes them to a surface of revolution.
class Revolution {
 public:
  explicit Revolution(int segments) : n_(static_cast<std::uint32_t>(segments)) {}

  void add(double radius, double z) {
    const Ring ring{static_cast<std::uint32_t>(mesh_.vertices.size()), radius == 0};
    if (ring.point) {
      mesh_.vertices.push_back({0, 0, z});
    } else {
      for (std::uint32_t i = 0; i < n_; ++i) {
        const double angle = 2 * std::numbers::pi * i / n_;
        mesh_.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
    }
    if (has_last_) connect(last_, ring);
    last_ = ring;
    has_last_ = true;
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  std::uint32_t vertex(const Ring& ring, std::uint32_t i) const {
    return ring.point ? ring.first : ring.first + i % n_;
  }
  void connect(const Ring& low, const Ring& high) {
    for (std::uint32_t i = 0; i < n_; ++i) {
      const std::uint32_t a = vertex(low, i), b = vertex(low, i + 1), c = vertex(high, i + 1),
                          d = vertex(high, i);
      if (!low.point) mesh_.triangles.push_back({a, b, c});
      if (!high.point) mesh_.triangles.push_back({a, c, d});
    }
  }

  std::uint32_t n_;
  TriangleMesh mesh_;
  Ring last_;
  bool has_last_ = false;
};

}  // namespace

TriangleMesh cone_mesh(double radius, double top_radius, double height, int segments,
                       const std::vector<std::string>& open) {
  const auto is_closed = [&](const char* end) { return std::ranges::find(open, end) == open.end(); };
  Revolution cone(segments);
  if (is_closed("-z")) cone.add(0, -height / 2);
  cone.add(radius, -height / 2);
  if (top_radius > 0) cone.add(top_radius, height / 2);
  if (top_radius == 0 || is_closed("+z")) cone.add(0, height / 2);
  return cone.take();
}

TriangleMesh capsule_mesh(double radius, double height, int segments) {
  Revolution capsule(segments);
  const int zones = std::max(2, (segments + 3) / 4);  // of each hemisphere
  capsule.add(0, -height / 2 - radius);
  for (const int side : {-1, 1})
    for (int i = side < 0 ? 1 : 0; i <= (side < 0 ? zones : zones - 1); ++i) {
      const double latitude = std::numbers::pi / 2 * (side < 0 ? i - zones : i) / zones;
      capsule.add(radius * std::cos(latitude), side * height / 2 + radius * std::sin(latitude));
    }
  capsule.add(0, height / 2 + radius);
  return capsule.take();
}

TriangleMesh height_field_mesh(double size_x, double size_y, const std::vector<std::vector<double>>& heights,
                               std::optional<double> base) {
  TriangleMesh mesh;
  const auto rows = static_cast<std::uint32_t>(heights.size()),
             columns = static_cast<std::uint32_t>(heights.front().size());
  const auto point = [&](std::uint32_t row, std::uint32_t column, double z) {
    mesh.vertices.push_back({size_x * (static_cast<double>(column) / (columns - 1) - 0.5),
                             size_y * (static_cast<double>(row) / (rows - 1) - 0.5), z});
  };
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) point(row, column, heights[row][column]);
  const auto at = [&](std::uint32_t row, std::uint32_t column) { return row * columns + column; };
  for (std::uint32_t row = 0; row + 1 < rows; ++row)
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      mesh.triangles.push_back({at(row, column), at(row, column + 1), at(row + 1, column + 1)});
      mesh.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row + 1, column)});
    }
  if (!base) return mesh;

  // The rim, counter-clockwise as seen from above.
  std::vector<std::uint32_t> rim;
  for (std::uint32_t column = 0; column + 1 < columns; ++column) rim.push_back(at(0, column));
  for (std::uint32_t row = 0; row + 1 < rows; ++row) rim.push_back(at(row, columns - 1));
  for (std::uint32_t column = columns - 1; column > 0; --column) rim.push_back(at(rows - 1, column));
  for (std::uint32_t row = rows - 1; row > 0; --row) rim.push_back(at(row, 0));
  const auto n = static_cast<std::uint32_t>(rim.size()), foot = rows * columns, centre = foot + n;
  for (const std::uint32_t v : rim) mesh.vertices.push_back({mesh.vertices[v].x, mesh.vertices[v].y, *base});
  mesh.vertices.push_back({0, 0, *base});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({foot + i, foot + next, rim[next]});
    mesh.triangles.push_back({foot + i, rim[next], rim[i]});
    mesh.triangles.push_back({centre, foot + next, foot + i});
  }
  return mesh;
}

}  // namespace tandem
