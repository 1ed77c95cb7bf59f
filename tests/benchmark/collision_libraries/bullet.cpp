#define BT_USE_DOUBLE_PRECISION
#include <bullet/BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <bullet/BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <bullet/btBulletCollisionCommon.h>

#include "library.hpp"

namespace collision_libraries {
namespace {

btVector3 bt(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Vector3d eigen(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform bt(const Isometry3d& X) {
  const Eigen::Quaterniond q(X.linear());
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), bt(Vector3d(X.translation())));
}

struct BulletGeometry : Geometry {
  std::unique_ptr<btCollisionShape> shape;
  std::unique_ptr<btTriangleMesh> mesh;
  std::vector<double> heights;
  btCollisionObject object;
};

struct Collect : btCollisionWorld::ContactResultCallback {
  std::vector<Point> points;
  const btCollisionObject* a = nullptr;
  btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const bool swapped = first->getCollisionObject() != a;
    Vector3d n = eigen(p.m_normalWorldOnB);
    if (swapped) n = -n;
    points.push_back({eigen(0.5 * (p.getPositionWorldOnA() + p.getPositionWorldOnB())), n, -p.getDistance()});
    return 0;
  }
};

class Bullet final : public Library {
 public:
  Bullet() : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_) {
    configuration_.setPlaneConvexMultipointIterations(4, 4);
  }
  std::string name() const override { return "Bullet 3.24 (float64)"; }
  std::unique_ptr<Geometry> make(const Shape& s) override {
    auto g = std::make_unique<BulletGeometry>();
    switch (s.kind) {
      case Shape::sphere:
        g->shape = std::make_unique<btSphereShape>(s.radius);
        break;
      case Shape::box:
        g->shape = std::make_unique<btBoxShape>(bt(Vector3d(0.5 * s.size)));
        break;
      case Shape::capsule:
        g->shape = std::make_unique<btCapsuleShapeZ>(s.radius, s.height);
        break;
      case Shape::cylinder:
        g->shape = std::make_unique<btCylinderShapeZ>(btVector3(s.radius, s.radius, 0.5 * s.height));
        break;
      case Shape::plane:
        g->shape = std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
        break;
      case Shape::hull: {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const Vector3d& v : s.vertices) hull->addPoint(bt(v), false);
        hull->recalcLocalAabb();
        hull->setMargin(0);
        hull->initializePolyhedralFeatures();
        g->shape = std::move(hull);
        break;
      }
      case Shape::mesh: {
        g->mesh = std::make_unique<btTriangleMesh>();
        for (const auto& t : s.triangles)
          g->mesh->addTriangle(bt(s.vertices[t[0]]), bt(s.vertices[t[1]]), bt(s.vertices[t[2]]));
        g->shape = std::make_unique<btBvhTriangleMeshShape>(g->mesh.get(), false);
        g->shape->setMargin(0);
        break;
      }
      case Shape::height_field: {
        g->heights.assign(s.samples * s.samples, 0.0);
        auto field = std::make_unique<btHeightfieldTerrainShape>(s.samples, s.samples, g->heights.data(), 0.,
                                                                 0., 2, false);
        const double cell = s.size.x() / (s.samples - 1);
        field->setLocalScaling(btVector3(cell, cell, 1));
        field->setMargin(0);
        g->shape = std::move(field);
        break;
      }
    }
    g->object.setCollisionShape(g->shape.get());
    return g;
  }
  std::vector<Point> collide(Geometry& a, const Isometry3d& X_a, Geometry& b,
                             const Isometry3d& X_b) override {
    // The algorithms of a simulation; contactPairTest() has others, which perturb the pose of boxes.
    auto &ga = static_cast<BulletGeometry&>(a), &gb = static_cast<BulletGeometry&>(b);
    ga.object.setWorldTransform(bt(X_a));
    gb.object.setWorldTransform(bt(X_b));
    btCollisionObjectWrapper wa(nullptr, ga.shape.get(), &ga.object, ga.object.getWorldTransform(), -1, -1),
        wb(nullptr, gb.shape.get(), &gb.object, gb.object.getWorldTransform(), -1, -1);
    btCollisionAlgorithm* algorithm =
        dispatcher_.findAlgorithm(&wa, &wb, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    std::vector<Point> points;
    if (!algorithm) return points;
    btManifoldResult result(&wa, &wb);
    algorithm->processCollision(&wa, &wb, info_, &result);
    btManifoldArray manifolds;
    algorithm->getAllContactManifolds(manifolds);
    for (int m = 0; m < manifolds.size(); ++m) {
      const bool swapped = manifolds[m]->getBody0() != &ga.object;
      for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
        const btManifoldPoint& p = manifolds[m]->getContactPoint(i);
        Vector3d n = eigen(p.m_normalWorldOnB);
        if (swapped) n = -n;
        if (p.getDistance() <= 0)
          points.push_back(
              {eigen(0.5 * (p.getPositionWorldOnA() + p.getPositionWorldOnB())), n, -p.getDistance()});
      }
    }
    algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm);
    return points;
  }
  std::optional<double> distance(Geometry& a, const Isometry3d& X_a, Geometry& b,
                                 const Isometry3d& X_b) override {
    const std::vector<Point> points = test(a, X_a, b, X_b, 10);
    if (points.empty()) return {};
    double d = HUGE_VAL;
    for (const Point& p : points) d = std::min(d, -p.depth);
    return d;
  }

 private:
  std::vector<Point> test(Geometry& a, const Isometry3d& X_a, Geometry& b, const Isometry3d& X_b,
                          double threshold) {
    auto &ga = static_cast<BulletGeometry&>(a), &gb = static_cast<BulletGeometry&>(b);
    ga.object.setWorldTransform(bt(X_a));
    gb.object.setWorldTransform(bt(X_b));
    Collect collect;
    collect.a = &ga.object;
    collect.m_closestDistanceThreshold = threshold;
    world_.contactPairTest(&ga.object, &gb.object, collect);
    return collect.points;
  }
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btDispatcherInfo info_;
  btCollisionWorld world_;
};

}  // namespace

std::unique_ptr<Library> make_bullet() {
  return std::make_unique<Bullet>();
}

}  // namespace collision_libraries
