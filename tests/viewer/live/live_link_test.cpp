#include "viewer/live/live_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/problem/problem.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

constexpr double radius = 0.06;  // m
const std::string worker = PALPATE_BIN_DIR "/palpate-worker";

/// A hand on a body, and a live solver.
class LiveLinkTest : public ::testing::Test {
 protected:
  /// Writes a program that stands for the live solver.
  std::string program(const std::string& commands) {
    const std::filesystem::path file = directory_ / "program";
    std::ofstream(file) << "#!/bin/sh\n" << commands << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file.string();
  }
  LiveLinkOptions options(const std::string& program = worker) const {
    return {encodeProblem(problem_), "", {}, program};
  }

  test::TemporaryDirectory directory_;
  Problem problem_ = test::fingeredBlob(radius);
  LiveTouch touch_{radius};
};

TEST_F(LiveLinkTest, SaysHowTheLiveSolverEnded) {
  LiveLink link(touch_, options(program("exit 7")));
  EXPECT_FALSE(link.waitUntilReady(std::chrono::minutes(1)));
  EXPECT_THAT(link.trouble(), testing::HasSubstr("7"));
}

}  // namespace
}  // namespace palpate
