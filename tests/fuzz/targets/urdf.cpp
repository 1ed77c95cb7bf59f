// Models in URDF. A scene made from a model must pass the checks again after it has been written.
#include "common/scene/parse.hpp"
#include "launch/import/import.hpp"
#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/shipped.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace urdf_part {

constexpr unsigned plain = 0, free_with_stops = 1, with_walls = 2, ways = 3;

class UrdfTarget : public Target {
 public:
  explicit UrdfTarget(const std::filesystem::path& folder) : folder_(folder) {
    put(folder_ / "particles.json", bytes_of(shipped_scene("chute")));
  }

  void run(std::span<const std::byte> input) override {
    launch::ImportOptions options;
    options.model = folder_ / "model.urdf";
    options.output = folder_ / "scene.json";
    const unsigned way = chosen(input, ways);
    if (way == free_with_stops) {
      options.free_root = true;
      options.stops = launch::StopStiffness{1e4, 1e6};
    } else if (way == with_walls) {
      options.into = folder_ / "particles.json";
      options.materials = {"glass"};
    }
    put(options.model, input);
    const launch::Imported imported = launch::import_urdf(options);
    try {
      scene::validate(scene::parse(imported.scene.dump(), "again"), "again");
    } catch (const std::exception& e) {
      throw Finding(std::string("an imported scene is refused: ") + e.what());
    }
  }

 private:
  std::filesystem::path folder_;
};

constexpr const char* arm = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 -0.5" rpy="0 0 0.3"/><mass value="2"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.18" iyz="0" izz="0.05"/></inertial>
    <collision><origin xyz="0 0 -0.5"/><geometry><box size="0.1 0.1 1"/></geometry></collision>
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
  </link>
  <link name="elbow"/>
  <link name="lower">
    <inertial><mass value="1"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.015"/></inertial>
    <collision><geometry><cylinder radius="0.05" length="0.8"/></geometry></collision>
  </link>
  <link name="slide">
    <inertial><mass value="0.5"/><inertia ixx="1" ixy="0.1" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 1" rpy="0 0.5 0"/><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/><dynamics damping="0.05" friction="0.1"/>
  </joint>
  <joint name="mount" type="fixed"><origin xyz="0 0 -0.9"/><parent link="upper"/><child link="elbow"/></joint>
  <joint name="hinge" type="continuous"><parent link="elbow"/><child link="lower"/><axis xyz="0 2 0"/></joint>
  <joint name="rail" type="prismatic">
    <parent link="lower"/><child link="slide"/><axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/>
    <mimic joint="hinge" multiplier="0.5"/>
  </joint>
</robot>
)";

std::vector<Bytes> models(const std::filesystem::path&) {
  std::vector<Bytes> corpus;
  std::string free_arm = arm;
  const std::string massless = "<link name=\"base\"/>";
  free_arm.replace(
      free_arm.find(massless), massless.size(),
      "<link name=\"base\"><inertial><mass value=\"9\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
      "iyz=\"0\" izz=\"1\"/></inertial></link>");
  for (const unsigned way : {plain, with_walls}) corpus.push_back(choice(way, bytes_of(arm)));
  corpus.push_back(choice(free_with_stops, bytes_of(free_arm)));
  return corpus;
}

}  // namespace urdf_part

TargetKind urdf_target() {
  using namespace urdf_part;
  return {.name = "urdf", .text = true, .corpus = models, .make = make_target<UrdfTarget>};
}

}  // namespace tandem::fuzz
