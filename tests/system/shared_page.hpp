#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "tests/support/command.hpp"
#include "tests/system/browser.hpp"

namespace palpate::test {

/// A page of `palpate share` for the dataset body.h5, in a browser.
struct SharedPage : testing::Test {
  TemporaryDirectory directory;

  void SetUp() override {
    if (runCommand("command -v chromium").exit_code != 0)
      GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  }
  CommandResult palpate(const std::string& arguments) const {
    return runCommand("cd '" + directory.path().string() + "' && " PALPATE_BIN_DIR "/palpate " +
                      arguments);
  }
  /// Returns whether the page exists now; without Emscripten it does not, and the test is skipped.
  /// Tests of a program share the pages of equal datasets.
  template <class Body>
  bool makePage(const Body& body) const {
    static std::map<std::string, std::string> pages;  // by the bytes of their datasets
    body.seal(directory / "body.h5");
    std::string& known = pages[bytesOf(directory / "body.h5")];
    if (!known.empty()) {
      std::ofstream(page(), std::ios::binary) << known;
      return true;
    }
    const CommandResult made = palpate("share body.h5 -o body.html");
    if (made.output.find("Emscripten") == std::string::npos) {
      EXPECT_EQ(made.exit_code, 0) << made.output;
      known = bytesOf(page());
      return made.exit_code == 0;
    }
    skip();
    return false;
  }
  static std::string bytesOf(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string page() const { return (directory / "body.html").string(); }
  void open(Browser& browser) const {
    browser.go(page());
    ASSERT_TRUE(browser.becomesTrue("document.body && document.body.dataset.state"));
    ASSERT_EQ(browser.valueOf("document.body.dataset.state"), "ready") << troubleOf(browser);
  }
  /// The message that is shown instead of the organ.
  static std::string troubleOf(Browser& browser) {
    return browser.valueOf("document.getElementById('trouble').innerText");
  }
  /// Waits until the hand is at rest and the page shows the answer for its position. An answer to
  /// an earlier position may arrive when the hand is already at rest.
  static void settle(Browser& browser) {
    ASSERT_TRUE(browser.becomesTrue(
        "palpate.touched && Math.abs(palpate.page.hand.depth - palpate.page.hand.wanted) < 1e-9 &&"
        "palpate.page.isAnswered(palpate.page.question())"));
  }

 private:
  static void skip() {
    GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  }
};

}  // namespace palpate::test
