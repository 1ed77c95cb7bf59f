#include "coordinator/mesh_import/mesh_import.hpp"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <bit>
#include <cctype>
#include <string>
#include <unordered_map>
#include <utility>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/utf8.hpp"
#include "coordinator/mesh_import/obj_file.hpp"
#include "coordinator/mesh_import/raw_mesh.hpp"
#include "coordinator/mesh_import/stl_file.hpp"

namespace tandem::launch {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem,
                       const std::string& hint) {
  throw Error(ErrorCode::scene, problem, file.string(), hint);
}

// assimp reads many formats; `scale` does not describe those with a scene graph or units of their own.
// Returns the file extension in lower case.
std::string require_format(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending != ".stl" && ending != ".obj")
    fail(file, "the mesh format '" + shortened(ending) + "' is not supported", "give an .stl or .obj file");
  return ending;
}

// The mesh file and no other: an OBJ file may name files of materials, which would be opened wherever they
// are.
class OneFile final : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string file) : file_(std::move(file)) {}
  bool Exists(const char* name) const override { return name == file_ && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return name == file_ ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  std::string file_;
};

// Adds the triangles of `part`, joining corners with equal coordinates. The file gives coordinates as floats,
// so that equal corners have equal bits.
class Joiner {
 public:
  Joiner(const std::filesystem::path& file, TriangleMesh& mesh, double scale)
      : file_(file), mesh_(mesh), scale_(scale) {}

  void add(const aiMesh& part) {
    index_.reserve(index_.size() + part.mNumFaces / 2);
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3)
        continue;  // points and lines, which the importer has put into parts of their own
      mesh_.triangles.push_back({vertex(part.mVertices[face.mIndices[0]]),
                                 vertex(part.mVertices[face.mIndices[1]]),
                                 vertex(part.mVertices[face.mIndices[2]])});
    }
  }

 private:
  std::uint32_t vertex(const aiVector3D& p) {
    const Vec3d position = scale_ * Vec3d{p.x, p.y, p.z};
    if (!is_finite(position)) fail(file_, "a corner has a coordinate that is not finite", "repair the mesh");
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [entry, is_new] = index_.try_emplace({p.x, p.y, p.z}, next);
    if (is_new) mesh_.vertices.push_back(position);
    return entry->second;
  }

  const std::filesystem::path& file_;
  TriangleMesh& mesh_;
  double scale_;
  using Corner = std::array<ai_real, 3>;
  struct Hash {
    std::size_t operator()(const Corner& corner) const {
      std::uint64_t hash = 0;
      // Adding 0 makes 0 and -0, which are equal, the same bits.
      for (const ai_real x : corner)
        hash = (hash ^ std::bit_cast<std::uint32_t>(x + ai_real{0})) * 0x9e3779b97f4a7c15u,
        hash ^= hash >> 29;
      return hash;
    }
  };
  std::unordered_map<Corner, std::uint32_t, Hash> index_;
};

}  // namespace

TriangleMesh read_raw_mesh(const std::filesystem::path& file, double scale) {
  const std::string ending = require_format(file);
  try {
    expect_input(file, {.largest = largest_mesh, .hint = "check the path"});
  } catch (const Error& error) {
    throw Error(error.code(), "the mesh file " + error.problem(), error.where(), error.hint());
  }
  ending == ".stl" ? expect_whole_stl(file) : expect_short_faces(file);

  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(file.string()));  // which the importer owns
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (!scene)
    fail(file, std::string("the mesh cannot be read: ") + importer.GetErrorString(),
         "give an STL or OBJ file");

  TriangleMesh mesh;
  Joiner joiner(file, mesh, scale);
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) joiner.add(*scene->mMeshes[i]);
  if (mesh.triangles.empty()) fail(file, "the mesh holds no triangle", "export it as a surface mesh");
  return mesh;
}

TriangleMesh import_mesh(const std::filesystem::path& file, double scale) {
  TriangleMesh mesh = read_raw_mesh(file, scale);
  if (const auto bad = degenerate_triangles(mesh); !bad.empty())
    fail(file,
         std::to_string(bad.size()) + " of " + std::to_string(mesh.triangles.size()) +
             " triangles have no area, the first is number " + std::to_string(bad.front() + 1),
         "repair the mesh in the program that made it, or by tandem mesh repair");
  return mesh;
}

}  // namespace tandem::launch
