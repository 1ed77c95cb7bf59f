// States on disk: values are restored to the bit, a file is complete or absent, and a wrong file is refused.
#include "common/state_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include "common/error.hpp"

namespace tandem {
namespace {

class StateFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void write() const {
    StateWriter file(path_, "toy state", 3);
    file.write("group/numbers", std::span<const double>(numbers_));
    file.write("count", std::uint64_t{1} << 63);
    file.write("text", std::string("grains"));
    file.write("empty", std::span<const std::byte>());
    file.commit();
  }
  std::string refusal(const std::string& kind = "toy state", std::uint64_t version = 3) const {
    try {
      const StateReader file(path_, kind, version);
      file.text("text");
      return "read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::resource);
      EXPECT_EQ(error.where(), path_.string());
      return error.problem();
    }
  }
  const std::vector<double> numbers_{0.1, -0.0, std::numeric_limits<double>::denorm_min(), INFINITY};
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("tandem_toy_state_" + std::to_string(getpid()) + ".h5");
};

TEST_F(StateFile, ValuesComeBackToTheBit) {
  write();
  const StateReader file(path_, "toy state", 3);
  std::vector<double> numbers(file.size("group/numbers"));
  file.read("group/numbers", std::span<double>(numbers));
  EXPECT_EQ(numbers, numbers_);
  EXPECT_TRUE(std::signbit(numbers[1]));
  std::uint64_t count = 0;
  file.read("count", count);
  EXPECT_EQ(count, std::uint64_t{1} << 63);
  EXPECT_EQ(file.text("text"), "grains");
  EXPECT_EQ(file.size("empty"), 0u);
  EXPECT_EQ(file.text("empty"), "");
}

TEST_F(StateFile, IsCompleteOrNotThere) {
  {
    StateWriter file(path_, "toy state", 3);
    file.write("count", std::uint64_t{1});
    EXPECT_TRUE(std::filesystem::exists(path_.string() + ".part"));
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".part"));
  EXPECT_THROW(StateWriter("/no/such/folder/state.h5", "toy state", 3), Error);
}

TEST_F(StateFile, NothingIsLeftWhereItCannotBePutIntoPlace) {
  std::filesystem::create_directories(path_ / "in the way");
  {
    StateWriter file(path_, "toy state", 3);
    EXPECT_THROW(file.commit(), Error);
  }
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".part"));
  std::filesystem::remove_all(path_);
}

TEST_F(StateFile, WrongFilesAreRefused) {
  EXPECT_EQ(refusal(), "does not exist");
  write();
  EXPECT_EQ(refusal(), "read");
  EXPECT_EQ(refusal("other state"), "is a 'toy state', not a 'other state'");
  EXPECT_EQ(refusal("toy state", 4), "is of version 3, this program reads 4");
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_EQ(refusal(), "is damaged: its digest does not fit");
  std::ofstream(path_) << "no HDF5";
  EXPECT_EQ(refusal(), "is no state of this version, or is damaged");
}

// At any position: HDF5 itself reads most of its own structure without a check.
TEST_F(StateFile, EveryChangedBitIsSeen) {
  write();
  std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(file)), {});
  const auto put = [&](std::size_t at, char byte) {
    file.clear();
    file.seekp(static_cast<std::streamoff>(at)).put(byte).flush();
  };
  for (std::size_t at = 0; at < all.size(); ++at) {
    put(at, static_cast<char>(all[at] ^ (1 << at % 8)));
    const std::string seen = refusal();
    ASSERT_TRUE(seen.starts_with("is damaged") || seen.starts_with("is no state")) << at << ": " << seen;
    put(at, all[at]);
  }
  EXPECT_EQ(refusal(), "read");
}

TEST_F(StateFile, HaveDigestsThatTellThemApart) {
  write();
  const std::uint64_t digest = file_digest(path_);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 stores times of day in seconds
  write();
  EXPECT_EQ(file_digest(path_), digest);
  {
    StateWriter file(path_, "toy state", 3);
    file.write("text", std::string("stones"));
    file.commit();
  }
  EXPECT_NE(file_digest(path_), digest);
  std::ofstream(path_) << "of another program";
  const std::uint64_t of_text = file_digest(path_);
  std::ofstream(path_) << "of another progran";
  EXPECT_NE(file_digest(path_), of_text);
  std::filesystem::remove(path_);
  EXPECT_THROW(file_digest(path_), Error);
}

TEST_F(StateFile, OtherSizesAreRefused) {
  write();
  const StateReader file(path_, "toy state", 3);
  double one = 0;
  EXPECT_THROW(file.read("group/numbers", one), Error);
  EXPECT_THROW(file.read("nothing", one), Error);
}

}  // namespace
}  // namespace tandem
