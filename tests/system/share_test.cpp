#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/touchable_body.hpp"
#include "tests/system/shared_page.hpp"
#include "tests/system/touchable_pixel.hpp"

/// A page of `palpate share`, pressed by mouse and finger.
namespace palpate {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct ShareTest : test::SharedPage {
  /// The latest answer of the page equals that of `palpate query`.
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
};

TEST_F(ShareTest, AMousePressesSlidesPressesDeeperAndReleases) {
  if (!makePage(test::FingerBody())) return;
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
  // A notch of the wheel is a thirtieth of the greatest press.
  ASSERT_TRUE(browser.becomesTrue(
      "Math.abs(palpate.page.hand.wanted - 0.01 - 4 * palpate.page.reach / 30) < 1e-9"));
  settle(browser);
  EXPECT_GT(browser.valueOf("Math.hypot(...palpate.touched.force)").get<double>(), before);
  expectAnswerOfQuery(browser, true);
  const std::string deep = fmt::format(
      "{:.1f} mm deep", 10 + 4 * 1000 * browser.valueOf("palpate.page.reach").get<double>() / 30);
  EXPECT_THAT(browser.valueOf("document.getElementById('numbers').innerText").get<std::string>(),
              testing::AllOf(HasSubstr("N"), HasSubstr("±"), HasSubstr(deep)));

  browser.mouse("mouseReleased", x + 40, y + 20);
  EXPECT_TRUE(browser.becomesTrue("palpate.touched === null"));
  EXPECT_TRUE(browser.becomesTrue("document.getElementById('force').textContent === '0.00'"));
}

TEST_F(ShareTest, AFingerOnATouchScreenPressesAnActiveNode) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  if (!makePage(test::TouchableBody(mesh, test::wholeSurface(mesh)))) return;
  test::Browser browser;
  browser.send("Emulation.setTouchEmulationEnabled", {{"enabled", true}});
  open(browser);
  const auto [x, y] = test::touchablePixel(browser);
  browser.touch("touchStart", {{x, y}});
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

/// Regression: the slider stopped earlier if a sixtieth of the reach was not a round number.
TEST_F(ShareTest, TheSliderComesToTheDeepestPress) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  if (!makePage(test::TouchableBody(mesh, test::wholeSurface(mesh), 0.05, 0.025))) return;
  test::Browser browser;
  open(browser);
  const json at_the_end = browser.valueOf(
      "(slider => { slider.value = slider.max; slider.dispatchEvent(new Event('input'));"
      "  return [palpate.page.hand.wanted, palpate.page.reach,"
      "          slider.getAttribute('aria-valuetext')]; })(document.getElementById('depth'))");
  EXPECT_NEAR(at_the_end.at(0).get<double>(), at_the_end.at(1).get<double>(), 1e-12);
  EXPECT_EQ(at_the_end.at(2), "50.0 mm");
}

TEST_F(ShareTest, APointerThatLeavesTheOrganPointsAtNothing) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  open(browser);
  const auto [x, y] = test::touchablePixel(browser);
  browser.mouse("mouseMoved", x, y);
  ASSERT_TRUE(browser.becomesTrue("palpate.page.gestures.over !== null"));
  const json beside = browser.valueOf(
      "(({left, top}) => [left + 5, top + 5])"
      "(document.getElementById('numbers').getBoundingClientRect())");
  browser.mouse("mouseMoved", beside[0], beside[1]);
  EXPECT_TRUE(browser.becomesTrue("palpate.page.gestures.over === null"));
}

TEST_F(ShareTest, DraggingBesideTheOrganTurnsIt) {
  if (!makePage(test::FingerBody())) return;
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

}  // namespace
}  // namespace palpate
