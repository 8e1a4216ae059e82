#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/command.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

/// The units of deploy/systemd as on a machine with Palpate installed, with the built programs.
struct UnitsTest : testing::Test {
  test::TemporaryDirectory directory;

  void SetUp() override {
    if (test::runCommand("systemd-analyze --version").exit_code != 0)
      GTEST_SKIP() << "systemd-analyze is not there (Debian package systemd): units are not read";
    takeOver("palpate-serve@.service", "palpate-serve@liver.service");
    takeOver("palpate-work.service", "palpate-work.service");
  }
  void takeOver(const std::string& unit, const std::string& as) const {
    std::ifstream in(std::filesystem::path(PALPATE_SOURCE_DIR) / "deploy/systemd" / unit);
    ASSERT_TRUE(in) << unit;
    std::ofstream out(directory / as);
    const std::string installed = "/usr/bin/";
    const std::string built = std::string(PALPATE_BIN_DIR) + "/";
    for (std::string line; std::getline(in, line);) {
      if (const auto at = line.find(installed); at != std::string::npos)
        line.replace(at, installed.size(), built);
      out << line << '\n';
    }
  }
  test::CommandResult analyze(const std::string& how, const std::string& unit) const {
    return test::runCommand("systemd-analyze " + how + " '" + (directory / unit).string() + "'");
  }
};

TEST_F(UnitsTest, AreReadBySystemdWithoutAWarning) {
  for (const char* unit : {"palpate-serve@liver.service", "palpate-work.service"}) {
    const auto verified = analyze("verify --man=no", unit);
    EXPECT_EQ(verified.exit_code, 0) << verified.output;
    EXPECT_EQ(verified.output, "") << unit;
  }
}

/// systemd rates the exposure of the units below 1.5 of 10. It is not 0 because the units need the
/// network, and see the folders of the machine.
TEST_F(UnitsTest, ExposeLittleOfTheMachine) {
  for (const char* unit : {"palpate-serve@liver.service", "palpate-work.service"}) {
    const auto judged = analyze("security --offline=true --threshold=15", unit);
    EXPECT_EQ(judged.exit_code, 0) << judged.output;
  }
}

}  // namespace
}  // namespace palpate
