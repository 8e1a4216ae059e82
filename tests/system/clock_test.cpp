#include <gtest/gtest.h>

#include "tests/system/small_build.hpp"

/// Machines whose clocks differ by days, simulated on one machine with libfaketime (Debian:
/// faketime).
namespace palpate {
namespace {

struct ClockTest : test::SmallBuild {
  static constexpr const char* library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";

  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer must be loaded before any other library";
#endif
    if (!std::filesystem::exists(library))
      GTEST_SKIP() << "no faketime: clocks that are apart were NOT tested";
  }
  std::unique_ptr<test::Process> startAt(const std::string& time, const std::string& program,
                                         const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {std::string("LD_PRELOAD=") + library, "FAKETIME=" + time,
                                      PALPATE_BIN_DIR "/" + program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return start("/usr/bin/env", words);
  }
};

TEST_F(ClockTest, ClocksThatAreDaysApartGiveTheSameDataset) {
  auto scheduler = startAt(
      "+40min", "palpate-scheduler",
      {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*", "--state", "state", "-o", "out.h5"});
  const std::string endpoint = endpointIn("state");
  auto behind = startAt("-3d", "palpate-worker", {"work", "--connect", endpoint});
  auto ahead = startAt("+3d", "palpate-worker", {"work", "--connect", endpoint});
  // The scheduler is killed, and started again with a clock behind that of its last run.
  ASSERT_TRUE(journalGrows(*scheduler, "state", 5000)) << scheduler->output();
  scheduler->stop(SIGKILL);
  scheduler =
      startAt("-1d", "palpate-scheduler",
              {"serve", "cube.toml", "--listen", endpoint, "--state", "state", "-o", "out.h5"});
  expectFinished(*scheduler);
  EXPECT_EQ(behind->wait(), 0) << behind->output();
  EXPECT_EQ(ahead->wait(), 0) << ahead->output();
  EXPECT_TRUE(test::contentOf(directory / "out.h5") == undisturbed());
}

}  // namespace
}  // namespace palpate
