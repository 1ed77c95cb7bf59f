// What POV-Ray receives: names stay text whatever they contain, a camera that stands still shows every frame.
#include "coordinator/report/pov_scene.hpp"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "common/error.hpp"
#include "coordinator/report/camera.hpp"
#include "coordinator/report/movie.hpp"
#include "coordinator/report/preview.hpp"
#include "coordinator/results/body_meshes.hpp"

namespace tandem::launch {
namespace {

scene::Scene two_bodies() {
  scene::Scene scene;
  scene.name = "two";
  scene.mbd.emplace();
  for (const char* name : {"a\"} #include \"/etc/passwd\" //", "rod\\"}) {
    scene::Body& body = scene.mbd->bodies.emplace_back();
    body.name = name;
  }
  scene::Joint joint;
  joint.name = "hinge";
  joint.position = {1, 2, 3};
  scene.mbd->joints.push_back(joint);
  return scene;
}

Frame with_box(const std::string& name, Vec3d centre) {
  Frame frame;
  frame.surfaces.push_back({name, false, transformed(box_mesh({1, 1, 1}), {centre, {}})});
  return frame;
}

View view_of(const std::vector<Frame>& frames) {
  View view;
  Extents extents(view.up);
  for (const Frame& frame : frames) extents.add(frame);
  view.camera = extents.camera(view.size.aspect());
  view.floor = extents.lowest();
  return view;
}

TEST(PovScene, QuotesNames) {
  const scene::Scene scene = two_bodies();
  const Frame frame = with_box(scene.mbd->bodies[0].name, {});
  std::ostringstream out;
  write_pov(out, frame, scene, view_of({frame}), {.labels = labels_of(scene, frame), .extents = true});
  const std::string text = out.str();
  EXPECT_EQ(text.find("\"} #include"), text.find("\\\"} #include") + 1);
  EXPECT_NE(text.find("\"rod\\\\\""), std::string::npos);
  EXPECT_NE(text.find("x: -0.5 to 0.5 m"), std::string::npos);
}

TEST(PovScene, HasTheColoursOfItsBodies) {
  scene::Scene scene = two_bodies();
  const std::vector<LegendEntry> legend = body_legend(scene);
  ASSERT_EQ(legend.size(), 2u);
  EXPECT_NE(legend[0].colour, legend[1].colour);
  const std::vector<Label> labels = labels_of(scene, with_box("rod\\", {5, 6, 7}));
  ASSERT_EQ(labels.size(), 3u);
  EXPECT_LT(norm(labels[1].at - Vec3d{5, 6, 7}), 1e-12);
  EXPECT_EQ(labels[1].colour, legend[1].colour);
  EXPECT_EQ(labels[2].at, (Vec3d{1, 2, 3}));
  EXPECT_TRUE(labels[2].is_point);
}

// Far from the origin the numbers that POV-Ray receives are still those of the picture.
TEST(PovScene, IsTheSameWhereverTheSceneIs) {
  const scene::Scene scene = two_bodies();
  const auto text = [&](Vec3d at) {
    const Frame frame = with_box("rod\\", at);
    std::ostringstream out;
    write_pov(out, frame, scene, view_of({frame}));
    return out.str();
  };
  EXPECT_EQ(text({0, 0, 0}), text({4096, -2048, 1024}));
}

// Of a box about the eye's target, the faces towards the eye are solid and the others clear.
TEST(PovScene, GroundOfContactIsSolidFromItsFront) {
  Frame frame = with_box("rod\\", {});
  frame.surfaces.push_back({contact_ground, true, box_mesh({2, 2, 2})});
  std::ostringstream out;
  write_pov(out, frame, two_bodies(), view_of({frame}));
  const std::string text = out.str();
  for (const char* pigment : {"<0.62,0.6,0.56,0>", "<0.62,0.6,0.56,0.88>"}) {
    const std::size_t at = text.find(pigment);
    ASSERT_NE(at, std::string::npos) << pigment;
    EXPECT_EQ(text.find("face_indices { 6,", text.rfind("mesh2", at)), text.rfind("face_indices", at));
  }
}

TEST(PovScene, ColoursOfTheSceneComeBeforeThoseOfTheOrder) {
  scene::Scene scene = two_bodies();
  scene.mbd->bodies[1].colour = Vec3d{0.125, 0.25, 0.5};
  EXPECT_EQ(body_legend(scene)[1].colour, (Vec3d{0.125, 0.25, 0.5}));
  EXPECT_EQ(body_legend(scene)[0].colour, body_colour(0));
  scene.dem.emplace();
  scene.dem->walls.push_back({.name = "red", .shape = scene::SphereShape{1}, .colour = Vec3d{0.75, 0, 0}});
  Frame frame = with_box("rod\\", {});
  frame.surfaces.push_back({"ground.wall.red", true, box_mesh({2, 2, 2})});
  std::ostringstream out;
  write_pov(out, frame, scene, view_of({frame}));
  EXPECT_NE(out.str().find("<0.75,0,0,"), std::string::npos);
  EXPECT_EQ(out.str().find("<0.72,0.78,0.84,"), std::string::npos);
}

// Two faces in one plane are drawn one behind the other: no two objects have the same distance.
TEST(PovScene, FacesInOnePlaneHaveAnOrder) {
  Frame frame = with_box("rod\\", {});
  frame.surfaces.push_back(frame.surfaces.front());
  std::ostringstream out;
  write_pov(out, frame, two_bodies(), view_of({frame}));
  std::set<std::string> scales;
  std::size_t found = 0;
  const std::string text = out.str();
  for (std::size_t at = 0; (at = text.find(" scale 0.9", at)) != std::string::npos; ++at, ++found)
    scales.insert(text.substr(at, text.find(" translate", at) - at));
  EXPECT_EQ(found, 3u) << "faces and edges of both, of which the first needs no scale";
  EXPECT_EQ(scales.size(), found);
}

// Bodies of a machine without particles are solid; a fixed wall casts no shadow, and neither does anything
// fall on the ground of the picture, which is no floor of the scene.
TEST(PovScene, ShadowsAreThoseOfBodies) {
  Frame frame = with_box("rod\\", {});
  frame.surfaces.push_back({"ground", true, box_mesh({3, 3, 3})});
  std::ostringstream out;
  write_pov(out, frame, two_bodies(), view_of({frame}));
  const std::string text = out.str();
  const std::size_t body = text.find("finish { body }"), wall = text.find("finish { body }", body + 1);
  ASSERT_NE(wall, std::string::npos);
  EXPECT_EQ(text.find("no_shadow", body), text.find("no_shadow", text.find('\n', body)));
  EXPECT_LT(text.find("no_shadow", wall), text.find('\n', wall));
  const std::size_t disc = text.find("disc {");
  EXPECT_LT(text.find("emission 1", disc), text.find('\n', disc));
}

TEST(PovScene, StandsStillInAFilm) {
  const Frame start = with_box("rod\\", {}), end = with_box("rod\\", {9, 0, 0});
  const View view = view_of({start, end});
  EXPECT_NEAR(view.camera.target.x, 4.5, 1e-12);
  EXPECT_NEAR(view.floor, -0.5, 1e-12);
}

TEST(Movie, SizesAreEvenAndNamed) {
  EXPECT_EQ(parse_picture_size("640x360").width, 640);
  EXPECT_EQ(parse_picture_size("640x360").height, 360);
  for (const char* wrong : {"", "640", "640x", "x360", "641x360", "640x361", "640x360x", "-640x360",
                            "640 x 360", "62x360", "640x9000", "99999999999x360"}) {
    try {
      parse_picture_size(wrong);
      FAIL() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), "--size");
      EXPECT_NE(error.hint().find("1280x720"), std::string::npos);
    }
  }
}

TEST(Movie, FieldsOfSpheresAreNamed) {
  EXPECT_STREQ(colour_field("spin").unit, "rad/s");
  try {
    colour_field("sped");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.hint().find("speed, radius, spin, group, material, contact_count, mean_stress"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace tandem::launch
