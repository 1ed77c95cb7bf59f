#include "coordinator/scene/geometry_review.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/scene/contact_sizes.hpp"

namespace tandem::launch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

scene::Body body(const char* name, Vec3d at = {}, double moment = 1e-6) {
  scene::Body result;
  result.name = name;
  result.mass = 2;
  result.inertia = {1e-6, moment, moment};
  result.pose.p_WB = at;
  return result;
}

scene::Joint joint(scene::JointType type, BodyId parent, BodyId child, Vec3d at = {}) {
  scene::Joint result;
  result.type = type;
  result.parent = parent;
  result.child = child;
  result.position = at;
  return result;
}

template <class Shape>
scene::Wall wall(const char* name, BodyId body, const Shape& shape) {
  scene::Wall result;
  result.name = name;
  result.body = body;
  result.shape = shape;
  return result;
}

// Spheres of radius 0.01 m in a domain of 1 m, and a mesh for a wall of the ground.
SceneFile with_mesh(const TriangleMesh& mesh, double scale = 1) {
  SceneFile file;
  file.scene.dem.emplace();
  scene::Dem& dem = *file.scene.dem;
  dem.domain = {{0, 0, 0}, {1, 0.5, 0.5}};
  dem.particles.emplace_back();
  dem.particles[0].radius_min = dem.particles[0].radius_max = 0.01;
  dem.walls.push_back(wall("funnel", ground, scene::MeshShape{"funnel.stl", scale}));
  file.meshes.push_back({"funnel", transformed(mesh, {}, scale)});
  file.mesh_facts.push_back({"funnel", "funnel.stl", scale, facts_of(file.meshes[0].mesh)});
  return file;
}

SceneFile reviewed(SceneFile file) {
  review_geometry(file);
  return file;
}

TEST(GeometryReview, NothingIsSaidOfAClosedMeshThatFits) {
  for (const double size : {0.021, 0.1, 0.9}) {
    const SceneFile file = reviewed(with_mesh(box_mesh({size, size / 2, size / 3})));
    EXPECT_THAT(file.warnings, IsEmpty()) << size;
    EXPECT_THAT(file.notes, IsEmpty()) << size;
  }
}

TEST(GeometryReview, AFileInMillimetres) {
  EXPECT_THAT(
      reviewed(with_mesh(box_mesh({100, 400, 50}))).warnings,
      ElementsAre(
          "wall \"funnel\" is 400 m wide, by funnel.stl with a scale of 1, in a domain of 1 m, and "
          "no part of it is in the domain at the start: is the file in mm? then give \"scale\": 0.001"));
}

TEST(GeometryReview, ASmallPartInMillimetresIsOutsideTheDomain) {
  // For 10 mm, ten times the domain: its surface is completely outside the domain.
  EXPECT_THAT(
      reviewed(with_mesh(box_mesh({10, 10, 10}))).warnings,
      ElementsAre(
          "wall \"funnel\" is 10 m wide, by funnel.stl with a scale of 1, in a domain of 1 m, and no part "
          "of it is in the domain at the start: is the file in mm? then give \"scale\": 0.001"));
  SceneFile file = with_mesh(box_mesh({10, 10, 10}));
  file.scene.dem->walls[0].pose.p_WB = {0, 0, 5};  // its lower face is a floor
  EXPECT_THAT(reviewed(file).warnings, IsEmpty());
}

TEST(GeometryReview, AMeshOutsideTheDomain) {
  SceneFile file = with_mesh(box_mesh({0.3, 0.3, 0.3}));
  file.scene.mbd.emplace();
  file.scene.mbd->bodies = {body("bucket", {0, 0, 2})};
  file.scene.dem->walls[0].body = {0};
  file.scene.dem->walls[0].pose.p_WB = {0, 0, -1.7};
  EXPECT_THAT(reviewed(file).warnings, IsEmpty());
  file.scene.dem->walls[0].pose.p_WB = {0, 0, -1.3};
  EXPECT_THAT(reviewed(file).warnings, IsEmpty()) << "the bucket may come in";
  file.scene.dem->walls[0].body = ground;
  EXPECT_THAT(
      reviewed(file).warnings,
      ElementsAre(
          "wall \"funnel\" is 0.3 m wide, by funnel.stl with a scale of 1, in a domain of 1 m, and no part "
          "of it is in the domain at the start: it acts on no sphere; check its position and scale"));
}

TEST(GeometryReview, AFileInCentimetres) {
  EXPECT_THAT(reviewed(with_mesh(box_mesh({40, 10, 5}))).warnings,
              ElementsAre(HasSubstr("is the file in cm? then give \"scale\": 0.01")));
}

TEST(GeometryReview, AScaleTooMuch) {
  EXPECT_THAT(
      reviewed(with_mesh(box_mesh({0.4, 0.1, 0.1}), 1e-3)).warnings,
      ElementsAre(
          "wall \"funnel\" is 0.0004 m wide, by funnel.stl with a scale of 0.001, in a domain of 1 m, "
          "less than the smallest sphere's diameter of 0.02 m: is a factor of 1000 missing? then give "
          "\"scale\": 1"));
}

TEST(GeometryReview, AMachineInMillimetres) {
  SceneFile file = with_mesh(box_mesh({1, 1, 1}));
  file.scene.mbd.emplace();
  file.scene.mbd->bodies = {body("a"), body("b", {0, 400, 0})};
  EXPECT_THAT(
      reviewed(file).warnings,
      ElementsAre(
          "the machine is 400 m wide, by the places of its bodies and joints, in a domain of 1 m: are "
          "they in mm? then multiply them by 1e-3"));
  file.scene.dem->domain.max = {4, 4, 4};
  file.scene.mbd->bodies[1].pose.p_WB = {0, 0.004, 0};
  EXPECT_THAT(reviewed(file).warnings,
              ElementsAre(HasSubstr("the machine is 0.004 m wide, by the places of its bodies "
                                    "and joints, in a domain of 4 m: is either")));
}

TEST(GeometryReview, AnInertiaInKilogramsAndMillimetres) {
  SceneFile file;
  file.scene.mbd.emplace();
  file.scene.mbd->bodies = {body("arm", {}, 2e4)};
  file.scene.mbd->joints = {joint(scene::JointType::revolute, ground, {0}, {0.5, 0, 0})};
  EXPECT_THAT(
      reviewed(file).warnings,
      ElementsAre(
          "body \"arm\" has a radius of gyration of 100 m, by its inertia of 2e+04 kg m2, in a machine "
          "of 0.5 m: is the inertia in kg mm2? then multiply it by 1e-6"));
  file.scene.mbd->bodies = {body("arm", {}, 4000)};  // 45 m: a flywheel behind a gear
  EXPECT_THAT(reviewed(file).warnings, IsEmpty());
}

TEST(GeometryReview, AMissingTriangleIsAWarningWhereSpheresPassThrough) {
  TriangleMesh mesh = box_mesh({0.3, 0.4, 0.5});
  mesh.triangles.pop_back();
  EXPECT_THAT(
      reviewed(with_mesh(mesh)).warnings,
      ElementsAre(
          "wall \"funnel\" has a hole in its mesh funnel.stl, as if triangles were missing; it is 0.2 m "
          "wide, at (-0.15, -0.2, 0.25) in the frame of the shape: spheres can pass through; close it in "
          "the program that made the mesh"));

  TriangleMesh fine = cylinder_mesh(0.2, 0.5, 200);
  fine.triangles.erase(fine.triangles.begin() + 10);
  const SceneFile file = reviewed(with_mesh(fine));
  EXPECT_THAT(file.warnings, IsEmpty());
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("too narrow for the smallest sphere, of 0.02 m")));
}

TEST(GeometryReview, AMissingTriangleIsAWarningWhereLiquidPassesThrough) {
  TriangleMesh mesh = box_mesh({0.3, 0.4, 0.5});
  mesh.triangles.pop_back();
  SceneFile file = with_mesh(mesh);
  file.scene.sph.emplace();
  file.scene.sph->spacing = 0.1;
  file.scene.sph->domain = file.scene.dem->domain;
  file.scene.sph->walls = file.scene.dem->walls;
  file.scene.dem.reset();
  EXPECT_THAT(reviewed(file).warnings,
              ElementsAre(HasSubstr("in the frame of the shape: liquid can pass through; close it")));
  file.scene.sph->spacing = 0.3;
  const SceneFile coarse = reviewed(file);
  EXPECT_THAT(coarse.warnings, IsEmpty());
  EXPECT_THAT(coarse.notes, ElementsAre(HasSubstr("less than a spacing of the liquid, of 0.3 m")));
}

TEST(GeometryReview, AnOpenTopIsANote) {
  const SceneFile file = reviewed(with_mesh(cylinder_mesh(0.2, 0.5, 32, {"+z"})));
  EXPECT_THAT(file.warnings, IsEmpty());
  EXPECT_THAT(
      file.notes,
      ElementsAre(HasSubstr(
          "wall \"funnel\" is not closed: its mesh funnel.stl has an opening of 32 edges, 0.398 m wide")));
  EXPECT_THAT(reviewed(with_mesh(cylinder_mesh(0.2, 0.5, 32, {"-z", "+z"}))).notes,
              ElementsAre(HasSubstr("has 2 openings, the widest of 32 edges")));
}

TEST(GeometryReview, CornersThatTheSolverDoesNotJoin) {
  const auto halves = [](double gap) {
    TriangleMesh mesh = box_mesh({0.4, 0.4, 0.4}, {"+z"});
    for (const auto& [i, j, k] : box_mesh({0.4, 0.4, 0.4}, {"-z"}).triangles)
      mesh.triangles.push_back({i + 8, j + 8, k + 8});
    for (const Vec3d& v : box_mesh({0.4, 0.4, 0.4}).vertices)
      mesh.vertices.push_back(v + Vec3d{0, 0, 0.4 + gap});
    return mesh;
  };
  EXPECT_THAT(reviewed(with_mesh(halves(1e-6))).notes,
              ElementsAre(HasSubstr(
                  "8 edges of wall \"funnel\" nearly meet others, with corners up to 1e-06 m apart")));
  EXPECT_THAT(reviewed(with_mesh(halves(1e-9))).notes, IsEmpty());
}

TEST(GeometryReview, AMeshMuchFinerThanSpheresNeed) {
  // 20,000 triangles on 2 pi 0.1 x 0.1 m2: 99 of them within a radius of 0.01 m, 396 within 0.02 m.
  const TriangleMesh ring = cylinder_mesh(0.1, 0.1, 10'000, {"-z", "+z"});
  SceneFile file = with_mesh(ring);
  EXPECT_THAT(reviewed(file).warnings, IsEmpty());
  file.scene.dem->particles[0].radius_max = 0.02;
  EXPECT_THAT(
      reviewed(file).warnings,
      ElementsAre(
          "wall \"funnel\" has 20000 triangles, with sides of some 0.0027 m, for spheres of radius 0.02 "
          "m: one at the wall is compared with some 3.6e+03 of them, 36 us of a core in every micro step; "
          "sides of about the radius are enough, 3.6e+02 triangles: tandem mesh coarsen funnel.stl "
          "-o coarse.stl --deviation 0.0002"));
  // The command works on the file, before the stretch.
  SceneFile stretched = file;
  stretched.mesh_facts[0].scale = 1e-3, stretched.mesh_facts[0].stretch = {4, 1, 2};
  EXPECT_THAT(reviewed(stretched).warnings,
              ElementsAre(HasSubstr("--deviation 5e-05 --scale 0.001, and keep the stretch")));
}

TEST(GeometryReview, AStretchIsNamedBesideTheScale) {
  SceneFile file = with_mesh(box_mesh({100, 400, 50}));
  file.mesh_facts[0].stretch = {1, 4, 1};
  EXPECT_THAT(reviewed(file).warnings,
              ElementsAre(HasSubstr("with a scale of 1 and a stretch of [1, 4, 1], in")));
  EXPECT_EQ(to_json(file.mesh_facts)[0]["stretch"].dump(), "[1.0,4.0,1.0]");
}

TEST(GeometryReview, BodiesPassThroughEachOther) {
  SceneFile file;
  file.scene.mbd.emplace();
  file.scene.dem.emplace();
  scene::Mbd& mbd = *file.scene.mbd;
  mbd.bodies = {body("chassis"), body("wheel")};
  mbd.joints = {joint(scene::JointType::revolute, {0}, {1})};
  file.scene.dem->walls = {wall("tyre", {1}, scene::SphereShape{0.1})};
  EXPECT_THAT(reviewed(file).notes, IsEmpty()) << "one body alone";
  file.scene.dem->walls.push_back(wall("hood", {0}, scene::SphereShape{0.1}));
  EXPECT_THAT(reviewed(file).notes, IsEmpty()) << "a joint decides";
  file.scene.dem->walls.push_back(wall("floor", ground, scene::SphereShape{0.1}));
  EXPECT_THAT(
      reviewed(file).notes,
      ElementsAre(
          "walls act on spheres only: body \"chassis\" can pass through wall \"floor\" of the ground, and so "
          "for 1 other pair; shapes with \"use\": \"contact\" (mbd.contact), limits of joints, bushings and "
          "springs can hold bodies apart"));
  mbd.joints.push_back(joint(scene::JointType::prismatic, ground, {0}));
  EXPECT_THAT(reviewed(file).notes, ElementsAre(HasSubstr("body \"wheel\" can pass through wall \"floor\"")));
  const auto touching = [](const char* name, BodyId body) {
    scene::Shape shape;
    shape.name = name;
    shape.use = scene::ShapeUse::contact;
    shape.body = body;
    shape.geometry = scene::SphereShape{0.1};
    return shape;
  };
  file.scene.contact.emplace();
  file.scene.contact->ground = {touching("floor", ground)};
  file.scene.shapes = {touching("tyre", {1})};
  EXPECT_THAT(reviewed(file).notes, IsEmpty()) << "the wheel touches the floor";
  file.scene.contact->ignore = {{BodyId{1}, ground}};
  EXPECT_THAT(reviewed(file).notes, ElementsAre(HasSubstr("body \"wheel\" can pass through wall \"floor\"")));
  file.scene.contact.reset(), file.scene.shapes.clear();
  mbd.joints[0].type = scene::JointType::fixed;
  EXPECT_THAT(reviewed(file).notes, IsEmpty()) << "welded to what the rail holds";
}

// A machine of 1 m, two parts of 0.1 m that touch, and ground of 50 m.
SceneFile with_contact(double tooth, double floor) {
  SceneFile file;
  scene::Mbd& mbd = file.scene.mbd.emplace();
  mbd.bodies = {body("wheel"), body("pinion", {1, 0, 0})};
  file.scene.contact.emplace();
  const auto add = [&](std::vector<scene::Shape>& to, const char* name, BodyId body, double width) {
    scene::Shape& shape = to.emplace_back();
    shape.name = name;
    shape.body = body;
    shape.use = scene::ShapeUse::contact;
    shape.geometry = scene::MeshShape{std::string(name) + ".stl", 1};
    file.drawn.push_back({body, name, {{{0, 0, 0}, {width, 0, 0}, {0, width / 2, 0}}, {{0, 1, 2}}}});
  };
  add(file.scene.shapes, "tooth", {0}, tooth);
  add(file.scene.shapes, "gap", {1}, 0.1);
  add(file.scene.contact->ground, "floor", ground, floor);
  return file;
}

TEST(GeometryReview, ShapesOfContactInAnotherUnitAreNamed) {
  EXPECT_THAT(reviewed(with_contact(0.1, 50)).warnings, IsEmpty());
  EXPECT_THAT(reviewed(with_contact(30, 50)).warnings, IsEmpty()) << "a long part";
  EXPECT_THAT(
      reviewed(with_contact(500, 50)).warnings,
      ElementsAre("shape \"tooth\" of contact is 500 m wide, by tooth.stl with a scale of 1, and the rest of "
                  "the machine 1 m: is the file in mm? then give \"scale\": 0.001"));
  EXPECT_THAT(reviewed(with_contact(1e30, 50)).warnings,
              ElementsAre(HasSubstr("\"tooth\" of contact is 1e+30 m wide")));
  EXPECT_THAT(reviewed(with_contact(0.1, 1e30)).warnings,
              ElementsAre(HasSubstr("\"floor\" of contact is 1e+30 m wide")));
  // Ground in mm; a size that the scene itself gives may be large.
  EXPECT_THAT(reviewed(with_contact(0.1, 1500)).warnings, IsEmpty()) << "a map";
  SceneFile large = with_contact(0.1, 3000);
  EXPECT_THAT(
      reviewed(large).warnings,
      ElementsAre("shape \"floor\" of contact is 3e+03 m wide, by floor.stl with a scale of 1, and the rest "
                  "of the machine 1 m: is the file in mm? then give \"scale\": 0.001"));
  large.scene.contact->ground.front().geometry = scene::BoxShape{};
  EXPECT_THAT(reviewed(large).warnings, IsEmpty());
}

// A scale that still leaves a machine of kilometres is none to try.
TEST(GeometryReview, TheScaleFits) {
  EXPECT_THAT(reviewed(with_contact(1e6, 50)).warnings,
              ElementsAre(HasSubstr("is the file in micrometres? then give \"scale\": 1e-06")));
  EXPECT_THAT(reviewed(with_contact(0.1, 1e8)).warnings,
              ElementsAre(HasSubstr("is the file in micrometres? then give \"scale\": 1e-06")));
  EXPECT_THAT(
      reviewed(with_contact(1e12, 50)).warnings,
      ElementsAre(HasSubstr("neither mm nor micrometres make it fit: check the file and its \"scale\"")));
  EXPECT_EQ(question_of_scale(1e6, 20, 0.5), "is the file in micrometres? then give \"scale\": 5e-07");
}

}  // namespace
}  // namespace tandem::launch
