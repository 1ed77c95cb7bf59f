#include "common/cores.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace tandem {
namespace {

class Cores : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  const std::filesystem::path root_ =
      std::filesystem::temp_directory_path() / ("tandem_cores_" + std::to_string(getpid()));
};

TEST_F(Cores, AreNotLimitedByGroupsThatSayNothing) {
  EXPECT_EQ(cores_of_groups(root_), 0u);
  write("proc/self/cgroup", "0::/a/b\n");
  EXPECT_EQ(cores_of_groups(root_), 0u);
  write("sys/fs/cgroup/a/b/cpu.max", "max 100000\n");
  EXPECT_EQ(cores_of_groups(root_), 0u);
}

TEST_F(Cores, AreThoseOfTheTightestGroup) {
  write("proc/self/cgroup", "1:name=x:/\n0::/a/b\n");
  write("sys/fs/cgroup/a/b/cpu.max", "400000 100000\n");
  EXPECT_EQ(cores_of_groups(root_), 4u);
  write("sys/fs/cgroup/a/cpu.max", "150000 100000\n");
  EXPECT_EQ(cores_of_groups(root_), 2u);
}

TEST_F(Cores, OfAContainerAreThoseOfTheTopmostGroup) {
  write("proc/self/cgroup", "0::/\n");
  write("sys/fs/cgroup/cpu.max", "300000 100000\n");
  EXPECT_EQ(cores_of_groups(root_), 3u);
  EXPECT_GE(usable_cores(), 1u);
}

}  // namespace
}  // namespace tandem
