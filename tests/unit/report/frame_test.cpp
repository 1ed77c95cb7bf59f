// Data read for the picture are consistent, or refused with the file and the numbers.
#include "coordinator/report/frame.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.hpp"
#include "coordinator/results/series/hdf5.hpp"

namespace tandem::launch {
namespace {

class FrameFiles : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void put_particles(std::size_t coordinates) const {
    Hdf5File file = Hdf5File::create(folder_ / "particles.h5");
    file.write("/frame_000000/position", std::span<const double>(std::vector<double>(coordinates, 1)));
    file.write("/frame_000000/radius", std::span<const float>(std::vector<float>(2, 1)));
    file.write("/frame_000000/speed", std::span<const float>(std::vector<float>(2, 1)));
    file.set_attribute("/frame_000000", "time", 0.5);
    file.commit();
  }
  void put_bodies(std::uint32_t corner) const {
    Hdf5File file = Hdf5File::create(folder_ / "bodies.h5");
    file.write("/bodies/box/vertices", std::span<const double>(std::vector<double>(9, 1)));
    file.write("/bodies/box/triangles",
               std::span<const std::uint32_t>(std::vector<std::uint32_t>{0, 1, corner}));
    file.make_group("/frame_000000");
    file.set_attribute("/frame_000000", "time", 0.5);
    file.commit();
  }
  std::string refusal() const {
    try {
      read_last_frame(folder_);
    } catch (const Error& error) {
      return error.problem();
    }
    return "read";
  }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_last_frame_" + std::to_string(getpid()));
};

TEST_F(FrameFiles, SpheresHaveAllTheirNumbers) {
  put_particles(6);
  EXPECT_EQ(refusal(), "read");
  put_particles(5);
  EXPECT_EQ(refusal(), "frame_000000 has 2 radii, 5 coordinates and 2 values of speed");
}

TEST_F(FrameFiles, AFrameWithoutItsSpheresIsDamaged) {
  {
    Hdf5File file = Hdf5File::create(folder_ / "particles.h5");
    file.make_group("/frame_000000");
    file.set_attribute("/frame_000000", "time", 0.5);
    file.commit();
  }
  EXPECT_EQ(refusal(), "frame_000000 lacks its spheres");
  Hdf5File lost = Hdf5File::create(folder_ / "particles.h5");
  lost.link("frame_000000", "frames/particles_000000.h5");
  lost.commit();
  try {
    read_last_frame(folder_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.hint(), "the file, or one that it links to, is damaged or missing");
  }
}

TEST_F(FrameFiles, TrianglesHaveVerticesThatAreThere) {
  put_bodies(2);
  EXPECT_EQ(refusal(), "read");
  put_bodies(3);
  EXPECT_EQ(refusal(), "a triangle of body 'box' has the vertex 3 of 3");
}

}  // namespace
}  // namespace tandem::launch
