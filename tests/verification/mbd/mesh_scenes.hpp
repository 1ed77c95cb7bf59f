// Scenes of bodies on meshes and height fields.
#pragma once

#include <functional>
#include <random>

#include "common/error.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "tests/verification/mbd/contact_machines.hpp"

namespace tandem::mbd::contacts {

struct MeshScene : ContactScene {
  std::vector<NamedMesh> meshes;

  using ContactScene::ContactScene;
  scene::Shape& add_ground(const std::string& name, scene::Geometry geometry) {
    scene::Shape shape;
    shape.name = name;
    shape.use = scene::ShapeUse::contact;
    shape.contact_material = 0;
    shape.geometry = std::move(geometry);
    scene.contact->ground.push_back(shape);
    return scene.contact->ground.back();
  }
  void add_ground_mesh(const std::string& name, TriangleMesh mesh) {
    add_ground(name, scene::MeshShape{"file", 1});
    meshes.push_back({"ground/" + name, std::move(mesh)});
  }
  BodyId add_mesh(const std::string& name, double mass, Vec3d inertia, Vec3d position,
                  TriangleMesh triangles) {
    meshes.push_back({name + "/" + name, std::move(triangles)});
    return add(name, mass, inertia, position, scene::MeshShape{"file", 1});
  }
  ContactRun run(double window) const { return ContactRun(scene, window, meshes); }
};

// z(x, y) on a grid of n cells over a square.
inline scene::HeightFieldShape field(double size_x, double size_y, int nx, int ny,
                                     const std::function<double(double, double)>& z) {
  scene::HeightFieldShape f{size_x, size_y, {}, {}};
  for (int row = 0; row <= ny; ++row) {
    f.heights.emplace_back();
    for (int column = 0; column <= nx; ++column)
      f.heights.back().push_back(z(size_x * (1. * column / nx - .5), size_y * (1. * row / ny - .5)));
  }
  return f;
}

// A plane of irregular triangles, of which some are slivers.
inline TriangleMesh irregular_plane(double size, int n) {
  TriangleMesh mesh = height_field_mesh(
      size, size,
      std::vector<std::vector<double>>(static_cast<std::size_t>(n) + 1,
                                       std::vector<double>(static_cast<std::size_t>(n) + 1)));
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> d(-0.45 * size / n, 0.45 * size / n);
  for (Vec3d& p : mesh.vertices)
    if (std::abs(p.x) < 0.49 * size && std::abs(p.y) < 0.49 * size) p.x += d(random), p.y += d(random);
  return mesh;
}

inline std::string refusal_of(const MeshScene& s, int windows, double window = 0.1) {
  try {
    ContactRun run = s.run(window);
    run.advance(windows);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace tandem::mbd::contacts
