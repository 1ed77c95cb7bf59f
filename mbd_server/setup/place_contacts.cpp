// The shapes of bodies that touch, and the pairs of them that may.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/error.hpp"
#include "common/geometry/convex_hull.hpp"
#include "common/geometry/solid_mesh.hpp"
#include "common/scene/shape_mesh.hpp"
#include "mbd_server/forces/joint_force.hpp"
#include "mbd_server/setup/placement.hpp"

namespace tandem::mbd {
namespace {

// Ratio of the tangential to the normal stiffness of a linear contact, as law `hooke` of the particles has.
constexpr double linear_ratio = 2. / 7;

const TriangleMesh& file_of(const scene::Scene& scene, const scene::Shape& shape,
                            const std::vector<NamedMesh>& meshes) {
  const std::string name = scene::contact_mesh_name(scene, shape);
  for (const NamedMesh& mesh : meshes)
    if (mesh.name == name) return mesh.mesh;
  throw Error(ErrorCode::scene, "the solver has not received the triangles of " + name,
              shape.path + ".shape.file", "send them with the scene, as tandem does");
}

// Twice the largest distance of points from their centre [m].
double diameter(const std::vector<Vec3d>& points) {
  Vec3d centre{};
  for (const Vec3d& p : points) centre = centre + (1 / static_cast<double>(points.size())) * p;
  double radius = 0;
  for (const Vec3d& p : points) radius = std::max(radius, norm(p - centre));
  return 2 * radius;
}

double diameter(const scene::Scene& scene, const scene::Shape& shape, const std::vector<NamedMesh>& meshes) {
  if (const auto* sphere = std::get_if<scene::SphereShape>(&shape.geometry)) return 2 * sphere->radius;
  if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape.geometry))
    return 2 * capsule->radius + capsule->height;
  if (const auto* cylinder = std::get_if<scene::CylinderShape>(&shape.geometry))
    return std::hypot(2 * cylinder->radius, *cylinder->height);
  if (const auto* box = std::get_if<scene::BoxShape>(&shape.geometry)) return norm(box->size);
  if (const auto* hull = std::get_if<scene::HullShape>(&shape.geometry); hull && hull->file.empty())
    return diameter(hull->points);
  if (const auto* field = std::get_if<scene::HeightFieldShape>(&shape.geometry))
    return diameter(height_field_mesh(field->size_x, field->size_y, field->heights, field->base).vertices);
  if (std::holds_alternative<scene::PlaneShape>(shape.geometry)) return 0;
  return diameter(file_of(scene, shape, meshes).vertices);
}

struct ContactPlacer {
  const Placement& at;
  Model& model;
  const scene::BodyContact& contact;
  const std::vector<NamedMesh>& meshes;

  // Where a shape is far too large a scale is missing.
  std::string text_of_file(const scene::Shape& shape) const {
    const std::string& name = scene::file_of(shape.geometry);
    if (name.empty()) return {};
    Vector3d low = Vector3d::Constant(HUGE_VAL), high = -low;
    for (const Vec3d& p : file_of(at.scene, shape, meshes).vertices)
      low = low.cwiseMin(to_eigen(p)), high = high.cwiseMax(to_eigen(p));
    const double scale = scene::scale_of(shape.geometry);
    const double width = (high - low).maxCoeff();
    // In millimetres, what is wider would still be more than a kilometre wide.
    const bool micro = width >= 1e6;
    return fmt::format("{} is {:.4g} m wide with a scale of {}{}", name, width,
                       scene::scale_text(scale, scene::stretch_of(shape.geometry)),
                       scale != 1 ? ""
                       : micro    ? ": a file in micrometres needs \"scale\": 1e-06"
                                  : ": a file in millimetres needs \"scale\": 0.001");
  }

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
    s.material = shape.contact_material;
    s.file = text_of_file(shape);
    if (const auto& surface = shape.surface_velocity)
      s.surface_velocity =
          std::get<scene::ConstantMotion>(surface->speed).value * to_eigen(surface->direction);
    const auto local = [&](const Vector3d& p) { return place(to_vec3(p)).p_LP; };
    if (const auto* sphere = std::get_if<scene::SphereShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::sphere;
      s.radius = s.bound = s.thickness = sphere->radius;
      s.points = {s.centre};
    } else if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::capsule;
      s.radius = s.thickness = capsule->radius;
      s.bound = capsule->radius + 0.5 * capsule->height;
      for (const double end : {-0.5, 0.5}) s.points.push_back(local({0, 0, end * capsule->height}));
      s.edges = {{0, 1, {}}};
    } else if (const auto* cylinder = std::get_if<scene::CylinderShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::cylinder;
      const double half = 0.5 * *cylinder->height;
      s.radius = cylinder->radius;
      s.thickness = std::min(s.radius, half);
      s.bound = std::hypot(s.radius, half);
      for (const double end : {-half, half}) s.points.push_back(local({0, 0, end}));
      s.edges = {{0, 1, {}}};
    } else if (const auto* box = std::get_if<scene::BoxShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::box;
      s.half_size = 0.5 * to_eigen(box->size);
      s.bound = s.half_size.norm();
      s.thickness = s.half_size.minCoeff();
      for (int corner = 0; corner < 8; ++corner)
        s.points.push_back(
            local({(corner & 1 ? 1 : -1) * s.half_size.x(), (corner & 2 ? 1 : -1) * s.half_size.y(),
                   (corner & 4 ? 1 : -1) * s.half_size.z()}));
      const int faces[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                               {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
      for (const auto& face : faces) s.faces.emplace_back().corners.assign(face, face + 4);
      finish(s);
    } else if (const auto* hull = std::get_if<scene::HullShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::hull;
      add_hull(hull->file.empty() ? hull->points : file_of(at.scene, shape, meshes).vertices, shape, s);
      finish_hull(s, local);
    } else if (std::holds_alternative<scene::MeshShape>(shape.geometry)) {
      add_mesh(file_of(at.scene, shape, meshes), shape, s, local);
    } else if (const auto* field = std::get_if<scene::HeightFieldShape>(&shape.geometry)) {
      add_mesh(height_field_mesh(field->size_x, field->size_y, field->heights, field->base), shape, s, local);
    } else if (const auto* plane = std::get_if<scene::PlaneShape>(&shape.geometry)) {
      s.kind = ContactShape::Kind::plane;
      s.centre = place(plane->point).p_LP;
      s.thickness = HUGE_VAL;
      const Vector3d n = (s.axes * to_eigen(plane->normal)).normalized();
      s.axes.col(2) = n;
      s.axes.col(0) = n.unitOrthogonal();
      s.axes.col(1) = n.cross(s.axes.col(0));
    } else {
      throw Error(ErrorCode::scene, "contact of bodies is not computed for this shape", shape.path);
    }
    model.contact.shapes.push_back(std::move(s));
  }

  template <class Local>
  static void finish_hull(ContactShape& s, const Local& local) {
    for (Vector3d& p : s.points) p = local(p);
    s.centre.setZero();
    for (const Vector3d& p : s.points) s.centre += p / static_cast<double>(s.points.size());
    for (const Vector3d& p : s.points) s.bound = std::max(s.bound, (p - s.centre).norm());
    finish(s);
    s.thickness = HUGE_VAL;
    for (const ContactShape::Face& face : s.faces)
      s.thickness = std::min(s.thickness,
                             face.normal.dot(s.points[static_cast<std::size_t>(face.corners[0])] - s.centre));
  }

  // On a plane a mesh touches with the corners of its hull; a flat one is fixed to the ground.
  template <class Local>
  void add_mesh(const TriangleMesh& mesh, const scene::Shape& shape, ContactShape& s, const Local& local) {
    if (s.link != 0) {
      add_hull(mesh.vertices, shape, s);
      finish_hull(s, local);
      s.faces.clear(), s.edges.clear();
    }
    s.kind = ContactShape::Kind::mesh;
    std::vector<Vector3d> vertices, in_file;
    const Vector3d unit = to_eigen(scene::units_of(shape.geometry));
    for (const Vec3d& p : mesh.vertices) {
      vertices.push_back(local(to_eigen(p)));
      in_file.push_back(to_eigen(p).cwiseQuotient(unit));
    }
    s.mesh = std::make_shared<ContactMesh>(vertices, in_file, mesh.triangles, shape.path + ".shape");
    s.centre = s.mesh->centre();
    s.bound = s.mesh->bound();
  }

  // Cylinders touch boxes and hulls as meshes.
  void add_surfaces() {
    const auto is_cylinder = [](const ContactShape& s) { return s.kind == ContactShape::Kind::cylinder; };
    if (std::ranges::none_of(model.contact.shapes, is_cylinder)) return;
    for (ContactShape& s : model.contact.shapes) {
      if (!s.is_polytope()) continue;
      std::vector<std::array<std::uint32_t, 3>> triangles;
      for (const ContactShape::Face& face : s.faces)
        for (std::size_t i = 1; i + 1 < face.corners.size(); ++i)
          triangles.push_back({static_cast<std::uint32_t>(face.corners[0]),
                               static_cast<std::uint32_t>(face.corners[i]),
                               static_cast<std::uint32_t>(face.corners[i + 1])});
      s.mesh = std::make_shared<ContactMesh>(s.points, s.points, triangles, "mbd.contact");
    }
  }

  // Normals of the faces; edges with their two faces.
  static void finish(ContactShape& s) {
    std::map<std::pair<int, int>, std::size_t> edges;
    for (std::size_t f = 0; f < s.faces.size(); ++f) {
      ContactShape::Face& face = s.faces[f];
      const auto at = [&](std::size_t i) {
        return s.points[static_cast<std::size_t>(face.corners[i % face.corners.size()])];
      };
      for (std::size_t i = 0; i < face.corners.size(); ++i) {
        face.normal += (at(i) - at(0)).cross(at(i + 1) - at(0));
        const int from = face.corners[i], to = face.corners[(i + 1) % face.corners.size()];
        const auto [found, is_new] = edges.try_emplace(std::minmax({from, to}), s.edges.size());
        if (is_new)
          s.edges.push_back({from, to, {static_cast<int>(f), static_cast<int>(f)}});
        else
          s.edges[found->second].faces[1] = static_cast<int>(f);
      }
      face.normal.normalize();
    }
  }

  // Corners of a hull in the frame of the shape, and its faces: triangles in one plane are one face.
  static void add_hull(const std::vector<Vec3d>& points, const scene::Shape& shape, ContactShape& s) {
    const std::optional<TriangleMesh> mesh = convex_hull(points);
    if (!mesh)
      throw Error(ErrorCode::scene, "the points of the shape are in one plane", shape.path + ".shape",
                  "add points outside of it");
    std::vector<int> corner_of(mesh->vertices.size(), none);
    const auto corner = [&](std::uint32_t v) {
      int& c = corner_of[v];
      if (c == none) {
        c = static_cast<int>(s.points.size());
        s.points.push_back(to_eigen(mesh->vertices[v]));
      }
      return c;
    };
    struct Plane {
      Vector3d normal;
      double height;
      std::set<std::pair<int, int>> boundary{};  // corner to corner
    };
    double size = 0;
    for (const Vec3d& p : points) size = std::max(size, norm(p - points[0]));
    std::vector<Plane> planes;
    for (const auto& triangle : mesh->triangles) {
      const int c[3] = {corner(triangle[0]), corner(triangle[1]), corner(triangle[2])};
      const auto p = [&](int i) { return s.points[static_cast<std::size_t>(c[i])]; };
      const Vector3d n = (p(1) - p(0)).cross(p(2) - p(0)).normalized();
      auto plane = std::find_if(planes.begin(), planes.end(), [&](const Plane& known) {
        return known.normal.dot(n) > 1 - 1e-12 && std::abs(known.height - n.dot(p(0))) < 1e-9 * size;
      });
      if (plane == planes.end()) plane = planes.insert(planes.end(), {n, n.dot(p(0))});
      for (int i = 0; i < 3; ++i) {
        const int from = c[i], to = c[(i + 1) % 3];
        // An edge that the face has in both directions is inside it.
        if (plane->boundary.erase({to, from}) == 0) plane->boundary.emplace(from, to);
      }
    }
    for (const Plane& plane : planes) {
      ContactShape::Face& face = s.faces.emplace_back();
      const std::map<int, int> next(plane.boundary.begin(), plane.boundary.end());
      const int first = next.begin()->first;
      for (int c = first;;) {
        face.corners.push_back(c);
        c = next.at(c);
        if (c == first) break;
        if (face.corners.size() > next.size())
          throw Error(ErrorCode::internal, "a face of the hull has no closed boundary",
                      shape.path + ".shape");
      }
    }
  }

  void find_apart() {
    model.contact.impacts_within_steps = contact.impacts == scene::Impacts::within_steps;
    model.contact.time_stepping = contact.impacts == scene::Impacts::time_stepping;
    auto& apart = model.contact.apart;
    const auto add_pair = [&](int a, int b) { apart.emplace_back(std::min(a, b), std::max(a, b)); };
    for (const SceneJoint& joint : model.joints)
      if (joint.type != scene::JointType::free && joint.parent != none && joint.child != none)
        add_pair(joint.parent, joint.child);
    const auto index = [](BodyId body) { return body == ground ? none : static_cast<int>(body.value); };
    for (const auto& pair : contact.ignore) add_pair(index(pair[0]), index(pair[1]));
    std::sort(apart.begin(), apart.end());
  }

  ContactLaw law(int m_a, int m_b) const {
    const scene::ContactMaterialPair pair = scene::combined(contact, m_a, m_b);
    ContactLaw law;
    law.friction = *pair.friction;
    law.rolling_friction = *pair.rolling_friction;
    law.damping_number = damping_number(*pair.restitution);
    const scene::ContactMaterial &one = contact.materials[static_cast<std::size_t>(m_a)],
                                 &two = contact.materials[static_cast<std::size_t>(m_b)];
    if (pair.stiffness) {
      law.stiffness = *pair.stiffness;
      law.tangential_ratio = linear_ratio;
    } else if (!one.stiffness && !two.stiffness) {
      // Hertz, with Mindlin's tangential stiffness.
      const double young =
          1 / ((1 - one.poisson * one.poisson) / one.young + (1 - two.poisson * two.poisson) / two.young);
      const double shear = 1 / (2 * (2 - one.poisson) * (1 + one.poisson) / one.young +
                                2 * (2 - two.poisson) * (1 + two.poisson) / two.young);
      law.hertz = true;
      law.stiffness = 4. / 3 * young;
      law.tangential_ratio = 4 * shear / young;
    }
    return law;
  }
};

void place_outputs(const Placement& placement, const std::vector<const scene::Shape*>& sources,
                   BodyContactModel& contact) {
  const std::vector<scene::ContactOutput>& outputs = placement.scene.contact->outputs;
  if (!outputs.empty()) contact.outputs_on.resize(sources.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const scene::ContactOutput& from = outputs[i];
    ContactOutput& output = contact.outputs.emplace_back();
    output.account = placement.of_contact[i];
    output.body = from.on[0].body == ground ? none : static_cast<int>(from.on[0].body.value);
    for (std::size_t s = 0; s < sources.size(); ++s) {
      const auto has = [&](const scene::ContactSide& side) { return scene::is_of(*sources[s], side); };
      output.on.push_back(std::ranges::any_of(from.on, has));
      output.from.push_back(from.from.empty() ? !output.on[s] : std::ranges::any_of(from.from, has));
      if (output.on[s]) contact.outputs_on[s].push_back(static_cast<int>(i));
    }
  }
}

}  // namespace

bool BodyContactModel::may_touch(int a, int b) const {
  const ContactShape &one = shape(a), &two = shape(b);
  if (one.link == two.link || (one.body != none && one.body == two.body)) return false;
  return !std::binary_search(apart.begin(), apart.end(),
                             std::pair{std::min(one.body, two.body), std::max(one.body, two.body)});
}

// A plane has no curvature.
ContactLaw BodyContactModel::law(int a, int b) const {
  const ContactShape &one = shape(a), &two = shape(b);
  ContactLaw law = laws[static_cast<std::size_t>(one.material * materials + two.material)];
  if (!law.hertz) return law;
  double curvature = 0;
  for (const ContactShape* s : {&one, &two})
    if (s->kind == ContactShape::Kind::sphere) curvature += 1 / s->radius;
  law.stiffness /= std::sqrt(curvature);
  return law;
}

void place_contacts(const Placement& placement, const std::vector<NamedMesh>& meshes, Model& model) {
  const scene::Scene& scene = placement.scene;
  if (!scene.contact) return;
  ContactPlacer placer{placement, model, *scene.contact, meshes};
  std::vector<const scene::Shape*> sources;  // (shapes)
  const auto add = [&](const scene::Shape& shape) {
    placer.add(shape);
    sources.resize(model.contact.shapes.size(), &shape);
  };
  for (const scene::Shape& shape : scene.contact->ground) add(shape);
  for (const scene::Shape& shape : scene.shapes)
    if (shape.use == scene::ShapeUse::contact) add(shape);
  placer.add_surfaces();
  placer.find_apart();
  place_outputs(placement, sources, model.contact);
  const int count = static_cast<int>(scene.contact->materials.size());
  model.contact.materials = count;
  for (int a = 0; a < count; ++a)
    for (int b = 0; b < count; ++b) model.contact.laws.push_back(placer.law(a, b));
}

double largest_contact_shape(const scene::Scene& scene, const std::vector<NamedMesh>& meshes) {
  double largest = 0;
  for (const scene::Shape& shape : scene.shapes)
    if (shape.use == scene::ShapeUse::contact) largest = std::max(largest, diameter(scene, shape, meshes));
  return largest;
}

}  // namespace tandem::mbd
