// Balls of a body on a mesh: the centre of a sphere, the ends of a capsule, the circles at the ends of a
// cylinder (rim.hpp) and the corners of a box or hull, on faces, edges and corners of the mesh.
#pragma once

#include <array>
#include <optional>

#include "mbd_server/contact/mesh_search.hpp"

namespace tandem::mbd {

class BallsOnMesh : MeshSearch {
 public:
  explicit BallsOnMesh(const MeshSearch& search) : MeshSearch(search) {}

  // Adds the features of a ball; returns whether the mesh is near.
  bool add(std::size_t i);
  // Adds the `watch` of the ball that was added last, where the mesh is near.
  void add_watch(std::size_t i);
  // That ball on the back of the mesh (mesh_back.hpp).
  std::optional<ContactFeature> behind(std::size_t i) const;

 private:
  struct Hit {
    ContactFeature::Kind kind;
    double gap;          // less the radius
    Vector3d foot, out;  // nearest place, direction to the ball
    Vector3d axis;       // normal of the face, direction of the edge
    int face;
    std::array<int, 3> corners{none, none, none};
    int root = none;  // the hit that stands for it
  };

  void plane_hit(int f, const Vector3d& c, double radius);
  void ball_hits(const Vector3d& c, double radius);
  void edge_hit(int f, int e, double s, const Vector3d& c, double radius);
  void corner_hit(int v, int f, double s, const Vector3d& c, double radius);
  void rim_hits(const Vector3d& c, const Vector3d& s);
  void rim_on_edge(const Vector3d& c, const Vector3d& s, int g);
  static bool meet(const Hit& one, const Hit& two);
  void keep_nearest();
  void corner_hits(std::size_t i, const Vector3d& c);
  bool stands_on(std::size_t corner, const Vector3d& normal) const;
  void add(std::size_t i, const Hit& hit);

  std::vector<int> visited_;
  std::vector<Hit> hits_;
};

}  // namespace tandem::mbd
