// Scenes of walls for the tests.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "particles/geometry/facet_contact.hpp"
#include "particles/geometry/surface.hpp"

namespace tandem::particles::test {

// std::uniform_real_distribution depends on the library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  Vec3d vector(double low, double high) {
    return {(*this)(low, high), (*this)(low, high), (*this)(low, high)};
  }

 private:
  std::mt19937_64 engine_;
};

inline scene::Scene empty_scene() {
  scene::Scene scene;
  scene.dem.emplace();
  scene.dem->domain = {{-100, -100, -100}, {100, 100, 100}};
  scene.dem->materials.push_back({"steel", 7800, 2e11, 0.3});
  return scene;
}

template <class Shape>
scene::Wall wall(const std::string& name, Shape shape, BodyId body = ground, Pose pose = {}) {
  scene::Wall w;
  w.name = name;
  w.body = body;
  w.pose = pose;
  w.shape = std::move(shape);
  return w;
}

inline Surface surface_of(const std::vector<scene::Wall>& walls, double reach,
                          const std::vector<NamedMesh>& meshes = {}) {
  scene::Scene scene = empty_scene();
  scene.dem->walls = walls;
  return make_surface(scene, meshes, reach);
}

inline Surface mesh_surface(const TriangleMesh& mesh, double reach) {
  return surface_of({wall("mesh", scene::MeshShape{"mesh.stl"})}, reach, {{"mesh", mesh}});
}

// Where collect_few_wall_contacts() has a result, it must have the same bits.
template <class Near>
void check_few(Vec3d centre, double radius, const Near& near, int count, const std::vector<Facet>& facets,
               const std::vector<WallContact>& expected) {
  FewWallContacts found;
  const int n = collect_few_wall_contacts(centre, radius, near, count, facets.data(), found);
  if (n == needs_general_rule) return;
  const WallContact few[] = {found.a, found.b, found.c};
  ASSERT_EQ(static_cast<std::size_t>(n), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_EQ(few[k].patch, expected[k].patch);
    ASSERT_EQ(few[k].neighbour, expected[k].neighbour);
    ASSERT_EQ(few[k].facet, expected[k].facet);
    ASSERT_EQ(few[k].normal, expected[k].normal);
    ASSERT_EQ(few[k].gap, expected[k].gap);
    ASSERT_EQ(few[k].point, expected[k].point);
  }
}

inline std::vector<WallContact> contacts(const Surface& s, Vec3d centre, double radius,
                                         std::size_t body = 0) {
  WallContactSpace space;
  const NearFacets near = near_facets(s.grids[body], s.cell_start.data(), s.cell_facet.data(), centre);
  const int n = collect_wall_contacts(centre, radius, near, near.count, s.facets.data(), space);
  if (n < 0) throw Error(ErrorCode::numerics, "too many contacts");
  const std::vector<WallContact> all(space.contacts.data(), space.contacts.data() + n);
  check_few(centre, radius, near, near.count, s.facets, all);
  return all;
}

}  // namespace tandem::particles::test
