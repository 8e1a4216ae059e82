#include "common/base/machine.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <fstream>
#include <thread>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

struct CoresOfGroupsTest : testing::Test {
  const test::TemporaryDirectory directory;

  void write(const std::string& file, const std::string& text) {
    std::filesystem::create_directories((directory / file).parent_path());
    std::ofstream(directory / file) << text << "\n";
  }
  std::optional<double> cores() {
    return coresOfGroups(directory / "groups", directory / "mounted");
  }
};

TEST_F(CoresOfGroupsTest, TheSmallestLimitOfAllEnclosingGroupsApplies) {
  write("groups", "0::/slice/job/step");
  write("mounted/slice/cpu.max", "200000 100000");
  write("mounted/slice/job/cpu.max", "150000 100000");
  write("mounted/slice/job/step/cpu.max", "max 100000");
  EXPECT_EQ(cores(), 1.5);
}

TEST_F(CoresOfGroupsTest, ReadsVersionOneToo) {
  write("groups", "1:cpu,cpuacct:/docker/abc\n0::/");
  // In a container, the file of groups has the path on the host, but only the container's own group
  // is mounted.
  write("mounted/cpu,cpuacct/cpu.cfs_quota_us", "300000");
  write("mounted/cpu,cpuacct/cpu.cfs_period_us", "100000");
  EXPECT_EQ(cores(), 3);
  write("mounted/cpu,cpuacct/cpu.cfs_quota_us", "-1");
  EXPECT_FALSE(cores());
}

TEST_F(CoresOfGroupsTest, HaveNoLimitWithoutGroups) {
  EXPECT_FALSE(cores());
  write("groups", "nonsense\n0::/../elsewhere");
  write("mounted/cpu.max", "max 100000");
  EXPECT_FALSE(cores());
}

TEST(Machine, AProcessPinnedToOneCoreHasOne) {
  EXPECT_GE(coreCount(), 1u);
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

TEST(Memory, IsRefusedWithTheRemedyIfTheSystemHasTooLittle) {
  EXPECT_NO_THROW(requireMemory(1u << 20));
  test::expectError(ExitCode::failed, [] { requireMemory(std::size_t{1} << 62); },
                    {"solving needs", "MiB"});
}

}  // namespace
}  // namespace palpate
