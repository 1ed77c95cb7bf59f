// The checkpoint from which a run continues, and the interval of writing states.
#include "coordinator/window/checkpoint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

class FindCheckpoint : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }
  void add(const fs::path& folder) const {
    fs::create_directories(folder);
    std::ofstream(folder / "run.h5") << "x";
  }
  static std::string refusal(const fs::path& path) {
    try {
      find_checkpoint(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      return error.problem();
    }
    return "none";
  }
  const fs::path base_ = fs::temp_directory_path() / ("tandem_checkpoint_" + std::to_string(getpid()));
};

TEST_F(FindCheckpoint, TakesTheHighestCompleteWindow) {
  add(base_ / "checkpoint" / "window_000009");
  add(base_ / "checkpoint" / "window_1000000");
  add(base_ / "checkpoint" / "window_999999");
  add(base_ / "checkpoint" / "window_000120_copy_of_mine");
  add(base_ / "checkpoint" / "window_-5");
  add(base_ / "checkpoint" / "window_");
  add(base_ / "z_and_a_longer_name_than_all_of_them");
  fs::create_directories(base_ / "checkpoint" / "window_2000000");  // not complete
  const fs::path newest = base_ / "checkpoint" / "window_1000000";
  for (const fs::path& path : {base_, base_ / "checkpoint", newest, newest / "run.h5"})
    EXPECT_EQ(find_checkpoint(path), newest);
}

TEST_F(FindCheckpoint, SaysWhatIsWrong) {
  EXPECT_EQ(refusal(base_), "holds no complete checkpoint");
  EXPECT_EQ(refusal(base_ / "nothing"), "does not exist");
  EXPECT_EQ(refusal(base_ / std::string(300, 'x')), "cannot be read: File name too long");
  fs::create_symlink("checkpoint", base_ / "checkpoint");
  EXPECT_EQ(refusal(base_), "cannot be read: Too many levels of symbolic links");
}

TEST(CheckpointInterval, IsOneThatNanosecondsCanCount) {
  EXPECT_EQ(checkpoint_interval(1e-9), Nanoseconds{1});
  EXPECT_EQ(checkpoint_interval(9e9), Nanoseconds{9'000'000'000'000'000'000});
  for (const double seconds : {-1.0, 0.0, 1e-10, 9.3e9, static_cast<double>(INFINITY), std::nan("")})
    EXPECT_THROW(checkpoint_interval(seconds), Error) << seconds;
}

}  // namespace
}  // namespace tandem::launch
