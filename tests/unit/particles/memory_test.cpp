// Available memory, and the error of a run that needs more.
#include "particles/base/memory.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <string>

#include "common/error.hpp"
#include "tests/support/made_up_host.hpp"

namespace tandem::test {
namespace {

TEST(Memory, ARunThatDoesNotFitIsRefusedWithFigures) {
  const particles::MemoryNeed need{2'000'000'000, 1'000'000, 128'000'000, "device"};
  EXPECT_NO_THROW(particles::expect_memory(need, 2'000'000'000));
  try {
    particles::expect_memory(need, 1'500'000'000);
    FAIL() << "fits";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::resource);
    EXPECT_EQ(e.problem(), "1000000 spheres need 2 GB of device memory, 2000 B each; 1.5 GB are free");
  }
  try {
    particles::expect_memory({1'000'000'000, 1000, 900'000'000, "host"}, 1);
    FAIL() << "fits";
  } catch (const Error& e) {
    EXPECT_NE(e.problem().find("0.9 GB of it for the cells of dem.domain"), std::string::npos) << e.what();
  }
  try {
    particles::expect_memory({2'000'000'000, 27, 0, "host", 1'900'000'000}, 1);
    FAIL() << "fits";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("1.9 GB of it for the loads of a window's micro steps"),
              std::string::npos);
    EXPECT_NE(std::string(e.what()).find("use shorter windows"), std::string::npos) << e.what();
  }
  EXPECT_GT(particles::available_memory(particles::Backend::cpu), 1'000'000u);
}

class HostMemory : public MadeUpHost {
 protected:
  void SetUp() override {
    write("proc/meminfo", "MemTotal: 9000000 kB\nMemFree: 5 kB\nMemAvailable: 4000000 kB\n");
  }
  std::size_t left(std::size_t addresses = std::numeric_limits<std::size_t>::max()) const {
    return particles::host_memory(root_, addresses);
  }
};

TEST_F(HostMemory, IsWhatTheHostHasWithoutLimits) {
  EXPECT_EQ(left(), 4'096'000'000u);
  write("proc/self/cgroup", "0::/a/b\n");
  write("sys/fs/cgroup/a/b/memory.max", "max\n");
  write("sys/fs/cgroup/a/b/memory.current", "1000\n");
  EXPECT_EQ(left(), 4'096'000'000u);
  write("proc/meminfo", "");
  EXPECT_EQ(left(), std::numeric_limits<std::size_t>::max()) << "not every host tells";
}

TEST_F(HostMemory, IsLimitedByEachOfItsControlGroups) {
  write("proc/self/cgroup", "0::/a/b\n");
  write("sys/fs/cgroup/a/b/memory.max", "2000000\n");
  write("sys/fs/cgroup/a/b/memory.current", "1500000\n");
  EXPECT_EQ(left(), 500'000u);
  write("sys/fs/cgroup/a/b/memory.stat", "anon 1000000\ninactive_file 300000\nactive_file 100000\n");
  EXPECT_EQ(left(), 900'000u) << "pages of files make room";
  write("sys/fs/cgroup/a/memory.max", "1000\n");
  write("sys/fs/cgroup/a/memory.current", "900\n");
  EXPECT_EQ(left(), 100u);
  write("sys/fs/cgroup/a/memory.current", "1900\n");
  EXPECT_EQ(left(), 0u);
}

TEST_F(HostMemory, IsLimitedByGroupsOfTheFirstVersion) {
  // In a container its group appears at the root, not at its path on the host.
  write("proc/self/cgroup", "5:cpu:/x\n4:hugetlb,memory:/docker/0123\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "3000\n");
  write("sys/fs/cgroup/memory/memory.usage_in_bytes", "2000\n");
  write("sys/fs/cgroup/memory/memory.stat", "total_inactive_file 50\n");
  EXPECT_EQ(left(), 1050u);
}

TEST_F(HostMemory, IsLimitedByTheAddressesOfTheProcess) {
  write("proc/self/statm", "100 20 10 1 0 50 0\n");
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  EXPECT_EQ(left(150 * page), 50 * page);
  EXPECT_EQ(left(50 * page), 0u);
}

}  // namespace
}  // namespace tandem::test
