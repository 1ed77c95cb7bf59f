#include "launch/results/results.hpp"

#include "common/error.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

TEST(Results, RowsHoldBodiesJointsAndLoads) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  const auto frame = toy::bodies_frame(0.5);
  const auto loads = toy::loads(7);
  results.record(frame.time, &frame, &loads);

  const Signals& bodies = results.bodies();
  EXPECT_EQ(bodies.column("time").back(), 0.5);
  EXPECT_EQ(bodies.column("rod.position.z").back(), 1.5);
  EXPECT_NEAR(bodies.column("wheel.orientation.w").back(), std::cos(0.25), 1e-15);
  EXPECT_NEAR(bodies.column("wheel.orientation.z").back(), std::sin(0.25), 1e-15);
  EXPECT_EQ(bodies.column("wheel.angular_velocity.z").back(), 1);
  EXPECT_EQ(bodies.column("rod.velocity.z").back(), 1);
  EXPECT_EQ(bodies.column("wheel.contact_force.x").back(), 7);
  EXPECT_EQ(bodies.column("wheel.contact_torque.y").back(), 7);
  EXPECT_EQ(bodies.column("rod.contact_force.x").back(), 0) << "no walls, no load";
  EXPECT_EQ(bodies.column("ground.contact_force.z").back(), -7);
  const Signals& joints = results.joints();
  EXPECT_EQ(joints.column("hinge.q").back(), 0.5);
  EXPECT_EQ(joints.column("hinge.rate").back(), 1);
  EXPECT_EQ(joints.column("hinge.reaction_force.z").back(), 3);
  EXPECT_EQ(joints.column("hinge.reaction_torque.x").back(), 4);
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
  EXPECT_EQ(results.bodies().column("ground.contact_force.z").back(), -7);
  EXPECT_TRUE(std::filesystem::exists(folder / "particles.xdmf"));
  EXPECT_TRUE(std::filesystem::exists(folder / "bodies.xdmf"));
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

TEST(Results, SeriesOfAnEarlierRunAreTakenAway) {
  const toy::Folder folder;
  std::ofstream(folder / "particles.xdmf") << "old";
  const Results results(folder, toy::machine(), {});
  EXPECT_FALSE(std::filesystem::exists(folder / "particles.xdmf"));
}

}  // namespace
}  // namespace tandem::launch
