#include "launch/results/results.hpp"

#include "common/error.hpp"
#include "launch/results/series/hdf5.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

double last(const Signals& signals, const std::string& name) {
  double value = 0;
  signals.visit({name}, [&](std::span<const double> row) { value = row[0]; });
  return value;
}

TEST(Results, RowsHoldBodiesJointsAndLoads) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  const auto frame = toy::bodies_frame(0.5);
  const auto loads = toy::loads(7);
  results.record(frame.time, &frame, &loads);

  const Signals& bodies = results.bodies();
  EXPECT_EQ(last(bodies, "time"), 0.5);
  EXPECT_EQ(last(bodies, "rod.position.z"), 1.5);
  EXPECT_NEAR(last(bodies, "wheel.orientation.w"), std::cos(0.25), 1e-15);
  EXPECT_NEAR(last(bodies, "wheel.orientation.z"), std::sin(0.25), 1e-15);
  EXPECT_EQ(last(bodies, "wheel.angular_velocity.z"), 1);
  EXPECT_EQ(last(bodies, "rod.velocity.z"), 1);
  EXPECT_EQ(last(bodies, "wheel.contact_force.x"), 7);
  EXPECT_EQ(last(bodies, "wheel.contact_torque.y"), 7);
  EXPECT_EQ(last(bodies, "rod.contact_force.x"), 0) << "no walls, no load";
  EXPECT_EQ(last(bodies, "ground.contact_force.z"), -7);
  const Signals& joints = results.joints();
  EXPECT_EQ(last(joints, "hinge.q"), 0.5);
  EXPECT_EQ(last(joints, "hinge.rate"), 1);
  EXPECT_EQ(last(joints, "hinge.reaction_force.z"), 3);
  EXPECT_EQ(last(joints, "hinge.reaction_torque.x"), 4);
}

TEST(Results, ElementsHaveAFileOfTheirOwn) {
  const toy::Folder folder;
  scene::Scene scene = toy::machine();
  scene.dem.reset();
  scene.mbd->forces.push_back(scene::Actuator{"drive", JointId{0}, scene::ConstantMotion{3, 0}});
  Results results(folder, scene, {});
  EXPECT_EQ(results.elements(), nullptr);
  results.add_elements();
  auto frame = toy::bodies_frame(0.5);
  EXPECT_THROW(results.record(frame.time, &frame, nullptr), Error) << "no values";
  frame.elements = {3, 2, 6, 1.5};
  results.record(frame.time, &frame, nullptr);
  EXPECT_EQ(toy::text_of(folder / "elements.csv"),
            "time,drive.torque,drive.speed,drive.power,drive.energy\n0.5,3,2,6,1.5\n");
  EXPECT_EQ(last(*results.elements(), "drive.power"), 6);
  EXPECT_EQ(results.signals().size(), 3u);
}

TEST(Results, AMachineWithoutElementsHasNoSuchFile) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  results.add_elements();
  EXPECT_EQ(results.elements(), nullptr);
  EXPECT_FALSE(std::filesystem::exists(folder / "elements.csv"));
}

TEST(Results, ParticlesOnly) {
  const toy::Folder folder;
  auto scene = toy::machine();
  scene.mbd.reset();
  scene.dem->walls.erase(scene.dem->walls.begin());
  Results results(folder, scene, {});
  auto loads = toy::loads(7);
  loads.bodies.pop_back();
  results.record({1000}, nullptr, &loads);
  const auto particles = toy::particles_frame(1e-6, 2);
  results.write_frame({1000}, nullptr, &particles);
  results.finish();
  EXPECT_EQ(last(results.bodies(), "ground.contact_force.z"), -7);
  EXPECT_TRUE(std::filesystem::exists(folder / "particles.xdmf"));
  EXPECT_TRUE(std::filesystem::exists(folder / "bodies.xdmf"));
}

// The check gets each frame, also where its memory is that of the results.
TEST(Results, FramesHaveTheFieldsThatTheSceneAsksFor) {
  const toy::Folder folder;
  scene::Scene scene = toy::machine();
  scene.mbd.reset();
  scene.dem->walls.clear();
  scene.dem->particles = {{.name = "sand", .material = {1}}, {.name = "gravel", .material = {0}}};
  using Field = scene::SphereField;
  scene.output.fields = {Field::mean_stress, Field::group, Field::material, Field::contact_count};
  Results results(folder, scene, {});
  results.set_groups({0, 0, 1, 1});
  protocol::ParticlesFrame frame{
      {0}, {0, 2, 3}, std::vector<double>(9), std::vector<float>(9), std::vector<float>(9), {1, 1, 1}};
  results.write_frame({0}, nullptr, &frame);
  EXPECT_THROW(results.finish(), Error) << "no contacts";
  frame.contacts = {3, 1.5f, 0, 0, 12, -2.5f};
  results.write_frame({0}, nullptr, &frame);
  results.finish();
  const Hdf5File file = Hdf5File::open(folder / "particles.h5");
  EXPECT_EQ(file.read_indices("/frame_000000/group"), (std::vector<std::uint32_t>{0, 1, 1}));
  EXPECT_EQ(file.read_indices("/frame_000000/material"), (std::vector<std::uint32_t>{1, 0, 0}));
  EXPECT_EQ(file.read_indices("/frame_000000/contact_count"), (std::vector<std::uint32_t>{3, 0, 12}));
  EXPECT_EQ(file.read_doubles("/frame_000000/mean_stress"), (std::vector<double>{1.5, 0, -2.5}));
  const std::string index = toy::text_of(folder / "particles.xdmf");
  for (const std::string_view field : scene::sphere_field_names)
    EXPECT_NE(index.find("Name=\"" + std::string(field) + '"'), std::string::npos) << field;
}

TEST(Results, FramesAreCheckedInTheirOrder) {
  const toy::Folder folder;
  auto scene = toy::machine();
  scene.mbd.reset();
  scene.dem->walls.erase(scene.dem->walls.begin());
  Results results(folder, scene, {});
  std::vector<std::size_t> checked;
  const auto check = [&](const protocol::ParticlesFrame& frame) { checked.push_back(frame.id.size()); };
  for (const std::uint32_t spheres : {2u, 3u}) {
    protocol::ParticlesFrame& frame = results.particles_to_write();
    frame = toy::particles_frame(1e-6, spheres);
    results.write_frame(frame.time, nullptr, &frame, check);
  }
  const auto other = toy::particles_frame(3e-6, 4);
  results.write_frame(other.time, nullptr, &other, check);
  results.finish();
  EXPECT_EQ(checked, (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/particles_000002.h5"));

  const auto refuse = [](const protocol::ParticlesFrame&) {
    throw Error(ErrorCode::protocol, "other spheres", "dem_server");
  };
  results.write_frame(other.time, nullptr, &other, refuse);
  try {
    results.finish();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.problem(), "other spheres");
  }
}

TEST(Results, BodiesOnly) {
  const toy::Folder folder;
  auto scene = toy::machine();
  scene.dem.reset();
  Results results(folder, scene, {});
  const auto frame = toy::bodies_frame(0.5);
  results.record(frame.time, &frame, nullptr);
  results.write_frame(frame.time, &frame, nullptr);
  results.finish();
  EXPECT_FALSE(results.bodies().has("wheel.contact_force.x"));
  EXPECT_FALSE(std::filesystem::exists(folder / "particles.h5"));
  EXPECT_TRUE(std::filesystem::exists(folder / "bodies.xdmf"));
}

TEST(Results, MissingStatesAreInternalErrors) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  const auto frame = toy::bodies_frame(0.5);
  const auto loads = toy::loads(7);
  EXPECT_THROW(results.record(frame.time, nullptr, &loads), Error);
  EXPECT_THROW(results.record(frame.time, &frame, nullptr), Error);
  EXPECT_THROW(results.write_frame(frame.time, &frame, nullptr), Error);
}

TEST(Results, FolderThatCannotBeMadeIsAResourceError) {
  try {
    const Results results("/dev/null/run", toy::machine(), {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::resource);
    EXPECT_EQ(error.where(), "/dev/null/run");
  }
}

}  // namespace
}  // namespace tandem::launch
