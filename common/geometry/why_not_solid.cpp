#include <limits>
#include <numeric>
#include <unordered_map>

#include "common/geometry/mass_properties.hpp"
#include "common/geometry/nesting.hpp"

namespace tandem {

namespace {

// The parts of a mesh that share no vertex, each as a mesh.
std::vector<TriangleMesh> parts_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [i, j, k] : mesh.triangles) root[find(j)] = root[find(k)] = find(i);
  std::unordered_map<std::uint32_t, std::size_t> index;
  std::vector<TriangleMesh> parts;
  std::vector<std::uint32_t> number(mesh.vertices.size(), std::numeric_limits<std::uint32_t>::max());
  for (auto triangle : mesh.triangles) {
    const auto [at, is_new] = index.try_emplace(find(triangle[0]), parts.size());
    if (is_new) parts.emplace_back();
    TriangleMesh& part = parts[at->second];
    for (std::uint32_t& v : triangle) {
      if (number[v] == std::numeric_limits<std::uint32_t>::max()) {
        number[v] = static_cast<std::uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[v]);
      }
      v = number[v];
    }
    part.triangles.push_back(triangle);
  }
  return parts;
}

// Names the first edge that is not used equally often in both directions.
std::string unpaired_edge(const TriangleMesh& mesh) {
  struct Use {
    int forward = 0, backward = 0;
  };
  std::unordered_map<std::uint64_t, Use> uses;
  uses.reserve(mesh.triangles.size() * 3 / 2);
  const auto key = [](std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      Use& use = uses[key(a, b)];
      ++(a < b ? use.forward : use.backward);
    }
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const Use use = uses[key(a, b)];
      if (use.forward == use.backward) continue;
      const std::string edge =
          "the edge from " + point_text(mesh.vertices[a]) + " to " + point_text(mesh.vertices[b]);
      const int count = use.forward + use.backward;
      return count == 1 ? edge + " belongs to one triangle only: the surface is open there"
                        : edge + " belongs to " + std::to_string(count) +
                              " triangles that do not wind in pairs of opposite directions";
    }
  return {};
}

// Names a part that would be counted twice, or with negative mass. Solids are inside an even number of
// others and wind as the whole does; cavities are inside an odd number and wind the other way.
std::string wrong_part(const TriangleMesh& mesh) {
  std::vector<ClosedPart> parts;
  for (TriangleMesh& part : parts_of(mesh)) parts.push_back(closed_part(std::move(part)));
  if (parts.size() < 2) return {};
  const Nesting nesting = nesting_of(parts);
  if (!nesting.unclear.empty())
    return why_unclear(parts[nesting.unclear.front().first], parts[nesting.unclear.front().second]);
  double total = 0;
  for (const ClosedPart& part : parts) total += part.volume;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t depth = nesting.around[i].size();
    const bool winds_as_solid = total < 0 ? parts[i].volume < 0 : parts[i].volume >= 0;
    if (winds_as_solid == (depth % 2 == 0)) continue;
    if (winds_as_solid)
      return part_text(parts[i]) + " is inside another one of the same winding: its volume would count twice";
    return part_text(parts[i]) +
           (depth == 0 ? " winds against the others and is inside none of them"
                       : " winds as the cavity that it is inside of") +
           ": its volume would be negative";
  }
  return {};
}

}  // namespace

std::string why_not_solid(const TriangleMesh& mesh) {
  if (std::string edge = unpaired_edge(mesh); !edge.empty()) return edge;
  if (signed_volume(mesh) == 0) return "the surface encloses no volume";
  return wrong_part(mesh);
}

}  // namespace tandem
