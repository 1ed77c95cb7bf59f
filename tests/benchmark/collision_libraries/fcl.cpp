#include <fcl/fcl.h>

#include "library.hpp"

namespace collision_libraries {
namespace {

struct FclGeometry : Geometry {
  std::shared_ptr<fcl::CollisionGeometryd> shape;
};

class Fcl final : public Library {
 public:
  std::string name() const override { return "FCL 0.7.0 (double)"; }
  std::unique_ptr<Geometry> make(const Shape& s) override {
    auto g = std::make_unique<FclGeometry>();
    switch (s.kind) {
      case Shape::sphere:
        g->shape = std::make_shared<fcl::Sphered>(s.radius);
        break;
      case Shape::box:
        g->shape = std::make_shared<fcl::Boxd>(s.size);
        break;
      case Shape::capsule:
        g->shape = std::make_shared<fcl::Capsuled>(s.radius, s.height);
        break;
      case Shape::cylinder:
        g->shape = std::make_shared<fcl::Cylinderd>(s.radius, s.height);
        break;
      case Shape::plane:
        g->shape = std::make_shared<fcl::Halfspaced>(Vector3d::UnitZ(), 0.);
        break;
      case Shape::hull: {
        auto vertices = std::make_shared<std::vector<Vector3d>>(s.vertices);
        auto faces = std::make_shared<std::vector<int>>();
        for (const auto& t : s.triangles) faces->insert(faces->end(), {3, t[0], t[1], t[2]});
        g->shape = std::make_shared<fcl::Convexd>(vertices, int(s.triangles.size()), faces);
        break;
      }
      case Shape::mesh: {
        auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
        std::vector<fcl::Triangle> triangles;
        for (const auto& t : s.triangles) triangles.emplace_back(t[0], t[1], t[2]);
        mesh->beginModel();
        mesh->addSubModel(s.vertices, triangles);
        mesh->endModel();
        g->shape = mesh;
        break;
      }
      case Shape::height_field:
        return nullptr;
    }
    g->shape->computeLocalAABB();
    return g;
  }
  std::vector<Point> collide(Geometry& a, const Isometry3d& X_a, Geometry& b,
                             const Isometry3d& X_b) override {
    fcl::CollisionRequestd request(64, true);
    fcl::CollisionResultd result;
    fcl::collide(static_cast<FclGeometry&>(a).shape.get(), X_a, static_cast<FclGeometry&>(b).shape.get(), X_b,
                 request, result);
    std::vector<Point> points;
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const auto& c = result.getContact(i);
      points.push_back({c.pos, -c.normal, c.penetration_depth});
    }
    return points;
  }
  std::optional<double> distance(Geometry& a, const Isometry3d& X_a, Geometry& b,
                                 const Isometry3d& X_b) override {
    // Its table has no function for the distance of a half space and a box, and it calls the empty entry.
    if (static_cast<FclGeometry&>(b).shape->getNodeType() == fcl::GEOM_HALFSPACE) return {};
    fcl::DistanceRequestd request(true, true);
    fcl::DistanceResultd result;
    return fcl::distance(static_cast<FclGeometry&>(a).shape.get(), X_a,
                         static_cast<FclGeometry&>(b).shape.get(), X_b, request, result);
  }
};

}  // namespace

std::unique_ptr<Library> make_fcl() {
  return std::make_unique<Fcl>();
}

}  // namespace collision_libraries
