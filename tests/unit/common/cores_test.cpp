#include "common/cores.hpp"

#include "tests/support/made_up_host.hpp"

namespace tandem::test {
namespace {

class Cores : public MadeUpHost {};

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
}  // namespace tandem::test
