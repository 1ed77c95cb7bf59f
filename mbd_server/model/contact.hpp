// Shapes of bodies that touch, which of them may, and by which law.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mbd_server/model/contact_mesh.hpp"
#include "mbd_server/model/indices.hpp"
#include "mbd_server/spatial/spatial.hpp"

namespace tandem::mbd {

// All in the frame of the link.
struct ContactShape {
  enum class Kind { plane, sphere, capsule, box, hull, mesh, cylinder } kind = Kind::sphere;
  std::string name;  // shape "tread" of body "wheel"
  std::string file;  // its file, width and scale, for messages; empty where it has none
  int body = none;   // body of the scene; none: ground
  LinkIndex link = 0;
  int material = 0;
  double radius = 0;                             // of sphere, capsule and cylinder [m]
  Vector3d centre = Vector3d::Zero();            // a point of the plane; else of the bounding sphere [m]
  Vector3d surface_velocity = Vector3d::Zero();  // along itself, as of a belt; with time_stepping only [m/s]
  Matrix3d axes = Matrix3d::Identity();          // of the box, as columns; the last is the plane's normal [-]
  Vector3d half_size = Vector3d::Zero();         // of the box [m]
  double bound = 0;                              // radius of the bounding sphere about `centre` [m]
  double thickness =
      0;  // a body that moves by less does not pass through it; where a mesh is touched that of its faces [m]
  // Of the sphere its centre, of capsule and cylinder the ends of the axis, of box and hull the corners, of a
  // mesh those of its convex hull [m].
  std::vector<Vector3d> points{};
  // Of box and hull: faces as corners in the order of the outward normal, edges as two corners. Each edge has
  // the indices of its two faces.
  struct Face {
    Vector3d normal = Vector3d::Zero();
    std::vector<int> corners{};
  };
  struct Edge {
    int from = 0, to = 0;
    std::array<int, 2> faces{};
  };
  std::vector<Face> faces{};
  std::vector<Edge> edges{};  // of capsule and cylinder the axis, without faces
  // Of a mesh or height field; and of box and hull, where there are cylinders.
  std::shared_ptr<const ContactMesh> mesh{};

  // Direction of the axis of capsule and cylinder.
  Vector3d axis() const { return (points[1] - points[0]).normalized(); }
  bool is_polytope() const { return kind == Kind::box || kind == Kind::hull; }
};

struct ContactLaw {
  bool hertz = false;           // force over depth to the power 3/2, else linear
  double stiffness = 0;         // [N/m^1.5] or [N/m]; of a ContactSurfaces with hertz: 4/3 E* [Pa]
  double tangential_ratio = 0;  // tangential over normal stiffness [-]
  double damping_number = 0;    // of the restitution, see forces/joint_force.hpp [-]
  double friction = 0;          // Coulomb coefficient [-]
  double rolling_friction = 0;  // largest rolling moment over R* N [-]
};

// Contacts whose forces on one side are a result (scene::ContactOutput).
struct ContactOutput {
  int account = none;          // see Model::accounts
  int body = none;             // torques are about its centre of mass; none: about the world's origin
  std::vector<bool> on, from;  // the two sides (shapes)
};

struct BodyContactModel {
  bool impacts_within_steps = false;  // steps end neither where contacts begin nor where they end
  bool time_stepping = false;         // steps are those of time_stepping/
  std::vector<ContactShape> shapes;
  std::vector<ContactLaw> laws;            // (materials x materials)
  std::vector<std::pair<int, int>> apart;  // bodies that pass through each other, sorted, first < second
  int materials = 0;
  std::vector<ContactOutput> outputs;
  std::vector<std::vector<int>> outputs_on;  // outputs on whose side the shape is (shapes; none: no outputs)

  bool empty() const { return shapes.empty(); }
  const ContactShape& shape(int i) const { return shapes[static_cast<std::size_t>(i)]; }
  // Whether two shapes touch where they meet.
  bool may_touch(int a, int b) const;
  ContactLaw law(int a, int b) const;
  // Whether contacts of two shapes begin and end within steps. Those with meshes never do: which part of a
  // mesh is nearest is found at the ends of steps.
  bool within_steps(int a, int b) const { return impacts_within_steps && !shape(a).mesh && !shape(b).mesh; }

  // Calls f(index of the output, sign) for the outputs that a contact of two shapes belongs to: a force on b
  // times this sign is the output's.
  template <class F>
  void for_each_output(int a, int b, F&& f) const {
    if (outputs.empty()) return;
    const auto add = [&](int on, int from, double sign) {
      for (const int i : outputs_on[static_cast<std::size_t>(on)])
        if (outputs[static_cast<std::size_t>(i)].from[static_cast<std::size_t>(from)]) f(i, sign);
    };
    add(b, a, 1), add(a, b, -1);
  }
};

}  // namespace tandem::mbd
