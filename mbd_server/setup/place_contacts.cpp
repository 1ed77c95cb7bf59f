// The shapes of bodies that touch, and the pairs of them that may.
#include <algorithm>
#include <set>

#include "common/error.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {
namespace {

// Ratio of the tangential to the normal stiffness of a linear contact, as law `hooke` of the particles has.
constexpr double linear_ratio = 2. / 7;

struct ContactPlacer {
  const Placement& at;
  Model& model;
  const scene::BodyContact& contact;
  std::vector<const scene::Shape*> shapes{};  // (contact shapes)

  void add(const scene::Shape& shape) {
    const bool on_ground = shape.body == ground;
    const Pose body = on_ground ? Pose{} : at.scene.mbd->bodies.at(shape.body.value).pose;
    const auto place = [&](Vec3d p) {
      return at.point(model, shape.body,
                      body.p_WB + body.q_WB.rotate(shape.pose.p_WB + shape.pose.q_WB.rotate(p)));
    };
    const Quaterniond turned = to_eigen(body.q_WB) * to_eigen(shape.pose.q_WB);
    ContactShape s;
    s.name = "shape \"" + shape.name + "\" of " +
             (on_ground ? std::string("the ground") : "body \"" + at.scene.body_name(shape.body) + "\"");
    s.body = on_ground ? none : static_cast<int>(shape.body.value);
    s.link = at.link_of(model, shape.body);
    s.centre = place({0, 0, 0}).p_LP;
    s.axes = turned.toRotationMatrix();
    if (const auto* sphere = std::get_if<scene::SphereShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::sphere;
      s.radius = sphere->radius;
    } else if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::capsule;
      s.radius = capsule->radius;
      for (const double end : {-0.5, 0.5}) s.points.push_back(place({0, 0, end * capsule->height}).p_LP);
    } else if (const auto* box = std::get_if<scene::BoxShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::box;
      s.half_size = 0.5 * to_eigen(box->size);
      for (int corner = 0; corner < 8; ++corner)
        s.points.push_back(
            place({(corner & 1 ? 0.5 : -0.5) * box->size.x, (corner & 2 ? 0.5 : -0.5) * box->size.y,
                   (corner & 4 ? 0.5 : -0.5) * box->size.z})
                .p_LP);
    } else if (const auto* hull = std::get_if<scene::HullShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::hull;
      for (const Vec3d& p : hull->points) s.points.push_back(place(p).p_LP);
    } else if (const auto* plane = std::get_if<scene::PlaneShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::plane;
      s.centre = place(plane->point).p_LP;
      const Vector3d n = (turned * to_eigen(plane->normal)).normalized();
      s.axes.col(2) = n;
      s.axes.col(0) = n.unitOrthogonal();
      s.axes.col(1) = n.cross(s.axes.col(0));
    } else {
      throw Error(ErrorCode::scene, "contact of bodies is not computed for this shape", shape.path);
    }
    model.contact_shapes.push_back(std::move(s));
    shapes.push_back(&shape);
  }

  bool are_neighbours(int a, int b) const {
    if (a == none || b == none) return false;
    return std::any_of(model.joints.begin(), model.joints.end(), [&](const SceneJoint& joint) {
      return joint.type != scene::JointType::free &&
             ((joint.parent == a && joint.child == b) || (joint.parent == b && joint.child == a));
    });
  }
  bool are_ignored(BodyId a, BodyId b) const {
    return std::any_of(contact.ignore.begin(), contact.ignore.end(), [&](const auto& pair) {
      return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
    });
  }

  ContactLaw law(int a, int b) const {
    const int m_a = shapes[static_cast<std::size_t>(a)]->contact_material,
              m_b = shapes[static_cast<std::size_t>(b)]->contact_material;
    const scene::ContactMaterialPair pair = scene::combined(contact, m_a, m_b);
    ContactLaw law;
    law.friction = *pair.friction;
    law.damping_number = damping_number(*pair.restitution);
    if (pair.stiffness) {
      law.stiffness = *pair.stiffness;
      law.tangential_ratio = linear_ratio;
      return law;
    }
    // Hertz, with Mindlin's tangential stiffness; a plane has no curvature.
    const scene::ContactMaterial &one = contact.materials[static_cast<std::size_t>(m_a)],
                                 &two = contact.materials[static_cast<std::size_t>(m_b)];
    const double young =
        1 / ((1 - one.poisson * one.poisson) / one.young + (1 - two.poisson * two.poisson) / two.young);
    const double shear = 1 / (2 * (2 - one.poisson) * (1 + one.poisson) / one.young +
                              2 * (2 - two.poisson) * (1 + two.poisson) / two.young);
    double curvature = 0;
    for (const int s : {a, b})
      if (const ContactShape& shape = model.contact_shapes[static_cast<std::size_t>(s)];
          shape.kind == ContactShape::Kind::sphere)
        curvature += 1 / shape.radius;
    law.hertz = true;
    law.stiffness = 4. / 3 * young / std::sqrt(curvature);
    law.tangential_ratio = 4 * shear / young;
    return law;
  }

  void pair_up() {
    using Kind = ContactShape::Kind;
    for (int i = 0; i < std::ssize(model.contact_shapes); ++i)
      for (int k = i + 1; k < std::ssize(model.contact_shapes); ++k) {
        const ContactShape &one = model.contact_shapes[static_cast<std::size_t>(i)],
                           &two = model.contact_shapes[static_cast<std::size_t>(k)];
        if (one.link == two.link || are_neighbours(one.body, two.body)) continue;
        if (are_ignored(shapes[static_cast<std::size_t>(i)]->body, shapes[static_cast<std::size_t>(k)]->body))
          continue;
        if (!scene::contact_is_computed(shapes[static_cast<std::size_t>(i)]->geometry,
                                        shapes[static_cast<std::size_t>(k)]->geometry))
          throw Error(ErrorCode::scene,
                      "the contact of " + one.name + " with " + two.name + " is not computed", "mbd.contact",
                      "list the two bodies under mbd.contact.ignore, or give other shapes");
        const bool reversed =
            one.kind == Kind::plane || (two.kind == Kind::sphere && one.kind != Kind::sphere);
        ContactPair pair;
        pair.a = reversed ? k : i, pair.b = reversed ? i : k;
        const ContactShape &a = model.contact_shapes[static_cast<std::size_t>(pair.a)],
                           &b = model.contact_shapes[static_cast<std::size_t>(pair.b)];
        pair.law = law(pair.a, pair.b);
        pair.count = b.kind == Kind::plane ? std::max(1, static_cast<int>(a.points.size())) : 1;
        pair.first = model.contact_points;
        model.contact_points += pair.count;
        model.contact_pairs.push_back(pair);
      }
  }
};

}  // namespace

void place_contacts(const Placement& placement, Model& model) {
  const scene::Scene& scene = placement.scene;
  if (!scene.contact) return;
  ContactPlacer placer{placement, model, *scene.contact};
  for (const scene::Shape& shape : scene.contact->ground) placer.add(shape);
  for (const scene::Shape& shape : scene.shapes)
    if (shape.use == scene::ShapeUse::contact) placer.add(shape);
  placer.pair_up();
}

}  // namespace tandem::mbd
