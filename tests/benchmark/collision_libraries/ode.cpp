#include <ode/ode.h>

#include "library.hpp"

namespace collision_libraries {
namespace {

struct OdeGeometry : Geometry {
  dGeomID id = nullptr;
  std::vector<double> vertices, planes, heights;
  std::vector<dTriIndex> indices;
  std::vector<unsigned> polygons;
  bool placeable = true;
  ~OdeGeometry() override {
    if (id) dGeomDestroy(id);
  }
};

class Ode final : public Library {
 public:
  Ode() { dInitODE2(0); }
  std::string name() const override { return "ODE 0.16.2 (double)"; }
  std::unique_ptr<Geometry> make(const Shape& s) override {
    auto g = std::make_unique<OdeGeometry>();
    for (const Vector3d& v : s.vertices) g->vertices.insert(g->vertices.end(), {v.x(), v.y(), v.z()});
    switch (s.kind) {
      case Shape::sphere:
        g->id = dCreateSphere(nullptr, s.radius);
        break;
      case Shape::box:
        g->id = dCreateBox(nullptr, s.size.x(), s.size.y(), s.size.z());
        break;
      case Shape::capsule:
        g->id = dCreateCapsule(nullptr, s.radius, s.height);
        break;
      case Shape::cylinder:
        g->id = dCreateCylinder(nullptr, s.radius, s.height);
        break;
      case Shape::plane:
        g->id = dCreatePlane(nullptr, 0, 0, 1, 0), g->placeable = false;
        break;
      case Shape::hull: {
        for (const auto& t : s.triangles) {
          const Vector3d &a = s.vertices[t[0]], &b = s.vertices[t[1]], &c = s.vertices[t[2]];
          const Vector3d n = (b - a).cross(c - a).normalized();
          g->planes.insert(g->planes.end(), {n.x(), n.y(), n.z(), n.dot(a)});
          g->polygons.insert(g->polygons.end(), {3u, unsigned(t[0]), unsigned(t[1]), unsigned(t[2])});
        }
        g->id = dCreateConvex(nullptr, g->planes.data(), unsigned(s.triangles.size()), g->vertices.data(),
                              unsigned(s.vertices.size()), g->polygons.data());
        break;
      }
      case Shape::mesh: {
        for (const auto& t : s.triangles)
          for (const int i : t) g->indices.push_back(dTriIndex(i));
        dTriMeshDataID data = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildDouble(data, g->vertices.data(), 3 * sizeof(double), int(s.vertices.size()),
                                    g->indices.data(), int(g->indices.size()), 3 * sizeof(dTriIndex));
        g->id = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
        break;
      }
      case Shape::height_field:
        return nullptr;  // its up axis is y; the shape would be rotated
    }
    return g;
  }
  std::vector<Point> collide(Geometry& a, const Isometry3d& X_a, Geometry& b,
                             const Isometry3d& X_b) override {
    auto &ga = static_cast<OdeGeometry&>(a), &gb = static_cast<OdeGeometry&>(b);
    place(ga, X_a), place(gb, X_b);
    dContactGeom contacts[64];
    const int n = dCollide(ga.id, gb.id, 64, contacts, sizeof contacts[0]);
    std::vector<Point> points;
    for (int i = 0; i < n; ++i)
      points.push_back({Vector3d(contacts[i].pos[0], contacts[i].pos[1], contacts[i].pos[2]),
                        Vector3d(contacts[i].normal[0], contacts[i].normal[1], contacts[i].normal[2]),
                        contacts[i].depth});
    return points;
  }
  std::optional<double> distance(Geometry&, const Isometry3d&, Geometry&, const Isometry3d&) override {
    return {};
  }

 private:
  static void place(OdeGeometry& g, const Isometry3d& X) {
    if (!g.placeable) return;
    const Eigen::Quaterniond q(X.linear());
    const dQuaternion quaternion{q.w(), q.x(), q.y(), q.z()};
    dGeomSetQuaternion(g.id, quaternion);
    dGeomSetPosition(g.id, X.translation().x(), X.translation().y(), X.translation().z());
  }
};

}  // namespace

std::unique_ptr<Library> make_ode() {
  return std::make_unique<Ode>();
}

}  // namespace collision_libraries
