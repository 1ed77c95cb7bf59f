#include "coordinator/results/results.hpp"

#include "common/error.hpp"
#include "coordinator/results/series/hdf5.hpp"
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

// The bin of the ground has ten triangles after those of the floor; the rim of the wheel is another body's.
TEST(Results, FramesHaveTheFieldsOfWalls) {
  const toy::Folder folder;
  scene::Scene scene = toy::machine();
  scene.dem->materials = {{.name = "steel", .density = 1, .young = 1, .poisson = 0, .hardness = 2e9}};
  scene.output.wall_fields = {"bin"};
  Results results(folder, scene, {});
  constexpr std::size_t stride = protocol::ParticlesFrame::wall_values;
  auto particles = toy::particles_frame(0.5, 2);
  const auto bodies = toy::bodies_frame(0.5);
  const auto write = [&] {
    results.write_frame(particles.time, &bodies, &particles);
    results.particles_to_write();  // waits
  };
  EXPECT_THROW(write(), Error) << "no values";
  particles.walls.assign(10 * stride, 1.0);
  write();
  particles.time = to_nanoseconds(1);
  for (std::size_t i = 0; i < particles.walls.size(); ++i)
    particles.walls[i] += static_cast<double>(i % stride) + 10.0 * static_cast<double>(i / stride);
  write();
  results.finish();
  const Hdf5File file = Hdf5File::open(folder / "bodies.h5");
  const auto values = [&](const std::string& name) {
    return file.read_doubles("/frame_000001/ground." + name);
  };
  const std::vector<double> force = values("force"), pressure = values("pressure"),
                            wear = values("wear_depth"), work = values("friction_work");
  const std::size_t floor = pressure.size() - 10, triangle = floor + 2;
  EXPECT_GT(floor, 0u);
  EXPECT_TRUE(std::isnan(pressure[0])) << "of the floor nothing is known";
  constexpr double area = 0.5, interval = 0.5;
  EXPECT_DOUBLE_EQ(force[3 * triangle + 1], (20 + 1) / interval);
  EXPECT_DOUBLE_EQ(pressure[triangle], (20 + 3) / interval / area);
  EXPECT_DOUBLE_EQ(values("shear_stress")[triangle], (20 + 4) / interval / area);
  EXPECT_DOUBLE_EQ(work[triangle], (1 + 20 + 5) / area);
  EXPECT_DOUBLE_EQ(wear[triangle], (1 + 20 + 6) / area / 2e9);
  EXPECT_TRUE(std::isnan(file.read_doubles("/frame_000000/ground.pressure")[triangle]))
      << "no time has passed";
  EXPECT_FALSE(file.has("/frame_000001/wheel.pressure"));
  EXPECT_NE(toy::text_of(folder / "bodies.xdmf")
                .find("Name=\"wear_depth\" AttributeType=\"Scalar\" Center=\"Cell\""),
            std::string::npos);
}

TEST(Results, FramesHaveTheContactsOfBodies) {
  const toy::Folder folder;
  scene::Scene scene = toy::machine();
  scene.output.contacts = {ground};
  Results results(folder, scene, {});
  auto particles = toy::particles_frame(0.5, 2);
  const auto bodies = toy::bodies_frame(0.5);
  results.write_frame(particles.time, &bodies, &particles);
  particles.of_bodies = {-1, 7, 1, 2, 3, 4, 5, 6, -1, 9, 10, 20, 30, 40, 50, 60};
  results.particles_to_write();
  results.write_frame(particles.time, &bodies, &particles);
  results.finish();
  const Hdf5File file = Hdf5File::open(folder / "contacts.h5");
  EXPECT_TRUE(file.read_doubles("/frame_000000/point").empty());
  EXPECT_EQ(file.read_doubles("/frame_000001/point"), (std::vector<double>{1, 2, 3, 10, 20, 30}));
  EXPECT_EQ(file.read_doubles("/frame_000001/force"), (std::vector<double>{4, 5, 6, 40, 50, 60}));
  EXPECT_EQ(file.read_doubles("/frame_000001/body"), (std::vector<double>{-1, -1}));
  EXPECT_EQ(file.read_indices("/frame_000001/sphere"), (std::vector<std::uint32_t>{7, 9}));
}

// The check gets each frame, also where its memory is that of the results.
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
