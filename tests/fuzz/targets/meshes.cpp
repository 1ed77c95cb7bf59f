// Mesh files, and the warnings about their surfaces.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "coordinator/mesh_import/mesh_facts.hpp"
#include "coordinator/mesh_import/mesh_import.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace meshes_part {

constexpr unsigned stl = 0, obj = 1, formats = 2;

class MeshesTarget : public Target {
 public:
  explicit MeshesTarget(const std::filesystem::path& folder) : folder_(folder) {}

  void run(std::span<const std::byte> input) override {
    const std::filesystem::path file = folder_ / (chosen(input, formats) == stl ? "mesh.stl" : "mesh.obj");
    put(file, input);
    const TriangleMesh mesh = launch::import_mesh(file, 0.001);
    expect(!mesh.triangles.empty() && degenerate_triangles(mesh).empty(), "a mesh without area is accepted");
    const launch::MeshFacts facts = launch::facts_of(mesh);
    expect(facts.triangles == mesh.triangles.size(), "the facts count other triangles");
    expect(std::isfinite(facts.area) && facts.area > 0, "the area of a mesh is no positive number");
    expect(std::isfinite(facts.diagonal()) && std::isfinite(facts.volume.value_or(0)),
           "the size of a mesh is not finite");
    for (const launch::Opening& opening : facts.openings)
      expect(std::isfinite(opening.width) && opening.edges <= 3 * mesh.triangles.size(),
             "an opening has no size");
  }

 private:
  std::filesystem::path folder_;
};

std::array<Vec3d, 3> corners(const TriangleMesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.triangles[triangle];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

Bytes ascii_stl(const TriangleMesh& mesh) {
  std::string text = "solid part\n";
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const Vec3d p : corners(mesh, i)) text += fmt::format("   vertex {} {} {}\n", p.x, p.y, p.z);
    text += "  endloop\n endfacet\n";
  }
  return bytes_of(text + "endsolid part\n");
}

Bytes binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    add(std::array<float, 3>{});
    for (const Vec3d p : corners(mesh, i))
      add(std::array{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    add(std::uint16_t{0});
  }
  bytes[0] = '\1';  // no text
  return bytes_of(bytes);
}

Bytes obj_file(const TriangleMesh& mesh) {
  std::string text = "# part\no part\n";
  for (const Vec3d p : mesh.vertices) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return bytes_of(text);
}

std::vector<Bytes> mesh_files(const std::filesystem::path&) {
  const TriangleMesh box = box_mesh({100, 200, 300}), open = cylinder_mesh(50, 200, 5, {"+z"});
  std::vector<Bytes> corpus;
  for (const TriangleMesh& mesh : {box, open}) {
    corpus.push_back(choice(stl, ascii_stl(mesh)));
    corpus.push_back(choice(stl, binary_stl(mesh)));
    corpus.push_back(choice(obj, obj_file(mesh)));
  }
  corpus.push_back(choice(
      obj, bytes_of("mtllib part.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng side\nusemtl "
                    "steel\ns off\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//-1 -3//-1 -2//-1\nl 1 2\np 1\n")));
  return corpus;
}

}  // namespace meshes_part

TargetKind meshes_target() {
  using namespace meshes_part;
  return {.name = "meshes",
          .text = true,
          .leaks = true,  // assimp 5.2, with OBJ files that it refuses
          .corpus = mesh_files,
          .make = make_target<MeshesTarget>};
}

}  // namespace tandem::fuzz
