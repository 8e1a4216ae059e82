#include "common/base/whole_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

/// A mark on a damaged record was once given up when the system took a part of it.
TEST(WriteAt, GoesOnWhereTheSystemTookAPartOnlyAndSaysWhyWhenItTakesNoMore) {
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

}  // namespace
}  // namespace palpate
