#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/touchable_body.hpp"
#include "tests/system/touchable_pixel.hpp"

/// A page that `palpate share` made, in the hands of who opens it.
namespace palpate {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct ShareTest : testing::Test {
  test::TemporaryDirectory directory;

  void SetUp() override {
    if (test::runCommand("command -v chromium").exit_code != 0)
      GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  }
  test::CommandResult palpate(const std::string& arguments) const {
    return test::runCommand("cd '" + directory.path().string() +
                            "' && " PALPATE_BIN_DIR "/palpate " + arguments);
  }
  /// Whether there is a page now; without Emscripten there is none.
  bool makePage() const {
    const test::CommandResult made = palpate("share body.h5 -o body.html");
    EXPECT_TRUE(made.exit_code == 0 || made.output.find("Emscripten") != std::string::npos)
        << made.output;
    return made.exit_code == 0;
  }
  std::string page() const { return (directory / "body.html").string(); }
  void open(test::Browser& browser) const {
    browser.go(page());
    ASSERT_TRUE(browser.becomesTrue("document.body && document.body.dataset.state"));
    ASSERT_EQ(browser.valueOf("document.body.dataset.state"), "ready")
        << browser.valueOf("document.getElementById('trouble').textContent");
  }
  /// The last answer of the field is that of `palpate query`.
  void expectAnswerOfQuery(test::Browser& browser, bool finger) const {
    const json felt = browser.valueOf("JSON.stringify(palpate.touched)");
    const json touched = json::parse(felt.get<std::string>());
    const auto numbers = [&](const char* what) {
      std::string text;
      for (const json& number : touched.at(what)) text += " " + number.dump();
      return text;
    };
    const test::CommandResult query = palpate("query body.h5 --json --displacement" + numbers("p") +
                                              (finger ? " --at" + numbers("s") : ""));
    ASSERT_EQ(query.exit_code, 0) << query.output;
    const json answer = json::parse(query.output);
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double force = answer.at("force").at(i);
      EXPECT_NEAR(touched.at("force").at(i).get<double>(), force, 1e-6);
      size += force * force;
    }
    EXPECT_GT(std::sqrt(size), 0.1) << "something is felt";
    EXPECT_NEAR(touched.at("bound").get<double>(), answer.at("error_bound").get<double>(), 1e-6);
  }
  /// The hand has come to rest, and the field with it.
  static void settle(test::Browser& browser) {
    ASSERT_TRUE(browser.becomesTrue(
        "palpate.touched && Math.abs(palpate.page.hand.depth - palpate.page.hand.wanted) < 1e-9 &&"
        "!palpate.page.waiting"));
  }
};

TEST_F(ShareTest, AMousePressesSlidesPressesDeeperAndLetsGo) {
  test::FingerBody().seal(directory / "body.h5");
  if (!makePage()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  test::Browser browser;
  open(browser);
  const auto [x, y] = test::touchablePixel(browser);
  browser.mouse("mouseMoved", x, y);
  browser.mouse("mousePressed", x, y);
  settle(browser);
  expectAnswerOfQuery(browser, true);
  const json first = browser.valueOf("palpate.touched.s");

  browser.mouse("mouseMoved", x + 40, y + 20);
  ASSERT_TRUE(browser.becomesTrue("palpate.touched.s[0] !== " + first.at(0).dump()));
  settle(browser);
  expectAnswerOfQuery(browser, true);

  const double before = browser.valueOf("Math.hypot(...palpate.touched.force)");
  browser.mouse("mouseWheel", x + 40, y + 20, -400);
  ASSERT_TRUE(browser.becomesTrue("palpate.page.hand.wanted > 0.0135"));
  settle(browser);
  EXPECT_GT(browser.valueOf("Math.hypot(...palpate.touched.force)").get<double>(), before);
  expectAnswerOfQuery(browser, true);
  EXPECT_THAT(browser.valueOf("document.getElementById('numbers').innerText").get<std::string>(),
              testing::AllOf(HasSubstr("N"), HasSubstr("±"), HasSubstr("14.0 mm deep")));

  browser.mouse("mouseReleased", x + 40, y + 20);
  EXPECT_TRUE(browser.becomesTrue("palpate.touched === null"));
  EXPECT_TRUE(browser.becomesTrue("document.getElementById('force').textContent === '0.00'"));
}

TEST_F(ShareTest, AFingerOnATouchScreenPressesAnActiveNode) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  test::TouchableBody(mesh, test::wholeSurface(mesh, [](const Eigen::Vector3d&) { return 1.0; }))
      .seal(directory / "body.h5");
  if (!makePage()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  test::Browser browser;
  browser.send("Emulation.setTouchEmulationEnabled", {{"enabled", true}});
  open(browser);
  const auto [x, y] = test::touchablePixel(browser);
  browser.touch("touchStart", x, y);
  settle(browser);
  const std::string name = browser.valueOf(
      "JSON.parse(document.getElementById('facts').textContent).touches[palpate.touched.touch]"
      ".name");
  const json touched =
      json::parse(browser.valueOf("JSON.stringify(palpate.touched)").get<std::string>());
  std::string p;
  for (const json& number : touched.at("p")) p += " " + number.dump();
  const test::CommandResult query =
      palpate("query body.h5 --json --active " + name + " --displacement" + p);
  ASSERT_EQ(query.exit_code, 0) << query.output;
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(touched.at("force").at(i).get<double>(),
                json::parse(query.output).at("force").at(i).get<double>(), 1e-6);
  EXPECT_GT(browser.valueOf("Math.hypot(...palpate.touched.force)").get<double>(), 0.05);
  browser.touch("touchEnd");
  EXPECT_TRUE(browser.becomesTrue("palpate.touched === null"));
}

TEST_F(ShareTest, DraggingBesideTheOrganTurnsIt) {
  test::FingerBody().seal(directory / "body.h5");
  if (!makePage()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  test::Browser browser;
  open(browser);
  const double turn = browser.valueOf("palpate.page.camera.turn");
  browser.mouse("mousePressed", 30, 400);
  browser.mouse("mouseMoved", 90, 400);
  browser.mouse("mouseReleased", 90, 400);
  EXPECT_TRUE(browser.becomesTrue("Math.abs(palpate.page.camera.turn - " + std::to_string(turn) +
                                  ") > 0.1"));
  EXPECT_EQ(browser.valueOf("!palpate.touched"), true);
}

TEST_F(ShareTest, WithoutWebGlThePageSaysWhatToDo) {
  test::FingerBody().seal(directory / "body.h5");
  if (!makePage()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  test::Browser browser({"--disable-3d-apis"});
  browser.go(page());
  ASSERT_TRUE(browser.becomesTrue("document.body && document.body.dataset.state === 'stopped'"));
  EXPECT_THAT(browser.valueOf("document.getElementById('trouble').innerText").get<std::string>(),
              testing::AllOf(HasSubstr("WebGL"), HasSubstr("hardware acceleration")));
}

TEST_F(ShareTest, ADamagedPageSaysSo) {
  test::FingerBody().seal(directory / "body.h5");
  if (!makePage()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  // Another organ in the place of this one: what no version of the field reads ("nothing").
  const std::string command =
      "cd '" + directory.path().string() +
      "' && python3 -c \"import re, zlib, base64; t = open('body.html').read(); "
      "o = base64.b64encode(zlib.compress(b'palpate-organ-0 and nothing')).decode(); "
      "open('body.html', 'w').write(re.sub('(id=.organ-bytes.[^>]*>)[^<]*', r'\\g<1>' + o, t))\"";
  ASSERT_EQ(test::runCommand(command).exit_code, 0);
  test::Browser browser;
  browser.go(page());
  ASSERT_TRUE(browser.becomesTrue("document.body && document.body.dataset.state"));
  EXPECT_EQ(browser.valueOf("document.body.dataset.state"), "stopped");
  EXPECT_THAT(browser.valueOf("document.getElementById('trouble').innerText").get<std::string>(),
              HasSubstr("palpate share"));
}

}  // namespace
}  // namespace palpate
