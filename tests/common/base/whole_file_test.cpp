#include "common/base/whole_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

/// Regression: a mark on a damaged record was abandoned after a partial write.
TEST(WriteAt, CompletesPartialWritesAndReportsTheErrorThatStopsIt) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "file").string();
  const int out = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(out, 0);
  EXPECT_TRUE(writeAt(out, 0, "0123456789"));
  EXPECT_TRUE(writeAt(out, 4, "xy"));

  // The first call writes up to the limit, the next one fails.
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit twelve = {12, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &twelve), 0);
  errno = 0;
  const bool all = writeAt(out, 8, "abcdefgh");
  const int reason = errno;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  close(out);
  EXPECT_FALSE(all);
  EXPECT_EQ(reason, EFBIG);
  EXPECT_EQ(readText(file, "file"), "0123xy67abcd");
}

struct ReplacedFile : testing::Test {
  test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "file", link = directory / "link";

  static mode_t modeOf(const std::filesystem::path& path) {
    struct stat info {};
    EXPECT_EQ(stat(path.c_str(), &info), 0);
    return info.st_mode & 0777;
  }
};

TEST_F(ReplacedFile, IsTheTargetOfALink) {
  std::filesystem::create_directory(directory / "disk");
  std::filesystem::create_symlink("disk/data", link);
  std::filesystem::create_symlink("link", directory / "second");
  for (const char* text : {"not there before", "replaced"}) {
    replaceFile(directory / "second", text, "text");
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_TRUE(std::filesystem::is_symlink(directory / "second"));
    EXPECT_EQ(readText(directory / "disk" / "data", "text"), text);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory / "disk"), {}), 1);
}

TEST_F(ReplacedFile, MustBeReachableThroughItsLinks) {
  std::filesystem::create_symlink("nowhere/data", link);
  test::expectError(ExitCode::failed, [&] { refuseUnwritable(link, "-o"); }, {"nowhere", "-o"});
  test::expectError(ExitCode::failed, [&] { refuseUnwritable(file.parent_path(), "-o"); },
                    {file.parent_path().string(), "-o"});
  std::filesystem::create_symlink("file", file);
  test::expectError(ExitCode::failed, [&] { replaceFile(file, "", "text"); }, {"loop"});
}

TEST_F(ReplacedFile, IsNeitherADeviceNorAPipe) {
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  test::expectError(ExitCode::failed, [&] { replaceFile(file, "", "text"); }, {"pipe"});
  EXPECT_TRUE(std::filesystem::is_fifo(file));
}

TEST_F(ReplacedFile, KeepsTheAdditionsOfConcurrentProcesses) {
  constexpr int processes = 8, lines = 20;
  replaceFile(file, "", "text");
  std::vector<pid_t> children;
  for (int n = 0; n < processes; ++n) {
    children.push_back(test::startChild([&] {
      for (int line = 0; line < lines; ++line)
        replaceFile(
            file, [&] { return readText(file, "text") + "x\n"; }, "text", 0600);
      return 0;
    }));
  }
  for (const pid_t child : children) EXPECT_EQ(test::codeOf(child), 0);
  EXPECT_EQ(readText(file, "text").size(), 2u * processes * lines);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1);
}

TEST_F(ReplacedFile, ReplacesLeftoversOfAKillWithTheRequestedPermissions) {
  std::ofstream(directory / "file.tmp") << "left behind, and longer than the new one";
  ASSERT_EQ(chmod((directory / "file.tmp").c_str(), 0644), 0);
  replaceFile(
      file, [] { return std::string("new"); }, "text", 0600);
  EXPECT_EQ(readText(file, "text"), "new");
  EXPECT_EQ(modeOf(file), 0600);
}

}  // namespace
}  // namespace palpate
