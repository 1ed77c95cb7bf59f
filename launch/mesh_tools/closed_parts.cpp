#include "launch/mesh_tools/closed_parts.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "common/geometry/nesting.hpp"

namespace tandem::launch {
namespace closed_parts {

// Vertices are numbered anew in each part.
std::vector<TriangleMesh> parts_of(const TriangleMesh& mesh, const std::vector<std::size_t>& part) {
  std::vector<TriangleMesh> parts(part.empty() ? 0 : 1 + *std::ranges::max_element(part));
  std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> number(parts.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleMesh& own = parts[part[t]];
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const auto [at, is_new] =
          number[part[t]].try_emplace(v, static_cast<std::uint32_t>(own.vertices.size()));
      if (is_new) own.vertices.push_back(mesh.vertices[v]);
      corners[k] = at->second;
    }
    own.triangles.push_back(corners);
  }
  return parts;
}

// Does each edge belong to as many triangles of one direction as of the other?
bool is_closed(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

}  // namespace closed_parts

TurnedParts turn_outwards(TriangleMesh& mesh, const std::vector<std::size_t>& part) {
  std::vector<TriangleMesh> all = closed_parts::parts_of(mesh, part);
  std::vector<ClosedPart> parts;
  std::vector<std::size_t> index(all.size(), SIZE_MAX);  // of each part among those that are closed
  for (std::size_t i = 0; i < all.size(); ++i)
    if (closed_parts::is_closed(all[i])) {
      index[i] = parts.size();
      parts.push_back(closed_part(std::move(all[i])));
    }
  const Nesting nesting = nesting_of(parts);
  // A part turns with the outermost part around it.
  TurnedParts turned;
  for (const auto& [inner, outer] : nesting.unclear)
    turned.unclear.push_back(why_unclear(parts[inner], parts[outer]));
  std::vector<bool> turns(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (nesting.is_unclear(i)) continue;
    const auto outermost =
        std::ranges::find_if(nesting.around[i], [&](std::size_t k) { return nesting.around[k].empty(); });
    const ClosedPart& outer = outermost == nesting.around[i].end() ? parts[i] : parts[*outermost];
    turns[i] = outer.volume < 0;
    if (turns[i]) ++(parts[i].volume < 0 ? turned.outwards : turned.inwards);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (index[part[t]] != SIZE_MAX && turns[index[part[t]]])
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return turned;
}

}  // namespace tandem::launch
