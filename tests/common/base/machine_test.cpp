#include "common/base/machine.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <fstream>
#include <thread>

#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

struct GroupLimitsTest : testing::Test {
  const test::TemporaryDirectory directory;

  void write(const std::string& file, const std::string& text) {
    std::filesystem::create_directories((directory / file).parent_path());
    std::ofstream(directory / file) << text << "\n";
  }
  GroupLimits limits() { return groupLimits(directory / "groups", directory / "mounted"); }
};

TEST_F(GroupLimitsTest, TheLeastOfAllGroupsAroundOneCounts) {
  write("groups", "0::/slice/job/step");
  write("mounted/slice/memory.max", "4294967296");
  write("mounted/slice/job/memory.max", "8589934592");
  write("mounted/slice/job/step/memory.max", "max");
  write("mounted/slice/job/cpu.max", "150000 100000");
  write("mounted/slice/job/step/cpu.max", "max 100000");
  EXPECT_EQ(limits().memory_bytes, 4294967296u);
  EXPECT_EQ(limits().cores, 1.5);
}

TEST_F(GroupLimitsTest, AreReadOfVersionOneToo) {
  write("groups", "4:memory:/docker/abc\n1:cpu,cpuacct:/docker/abc\n0::/");
  // In a container, where the path is that of the machine.
  write("mounted/memory/memory.limit_in_bytes", "1073741824");
  write("mounted/cpu,cpuacct/cpu.cfs_quota_us", "300000");
  write("mounted/cpu,cpuacct/cpu.cfs_period_us", "100000");
  EXPECT_EQ(limits().memory_bytes, 1073741824u);
  EXPECT_EQ(limits().cores, 3);
  write("mounted/cpu,cpuacct/cpu.cfs_quota_us", "-1");
  EXPECT_FALSE(limits().cores);
}

TEST_F(GroupLimitsTest, NoneIsSetWhereThereAreNoGroups) {
  EXPECT_FALSE(limits().memory_bytes);
  write("groups", "nonsense\n0::/../elsewhere");
  write("mounted/memory.max", "max");
  EXPECT_FALSE(limits().memory_bytes);
  EXPECT_FALSE(limits().cores);
}

TEST(Machine, AProcessThatMayRunOnOneCoreHasOne) {
  EXPECT_GE(coreCount(), 1u);
  ASSERT_TRUE(memoryBytes());
  EXPECT_GT(*memoryBytes(), std::uint64_t{1} << 20);
  std::jthread([] {
    cpu_set_t allowed, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
    int core = 0;
    while (!CPU_ISSET(core, &allowed)) ++core;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(coreCount(), 1u);
  }).join();
}

}  // namespace
}  // namespace palpate
