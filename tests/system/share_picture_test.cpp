#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/finger_body.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/touchable_body.hpp"
#include "tests/system/shared_page.hpp"
#include "tests/system/touchable_pixel.hpp"
#include "viewer/fields/relative_error.hpp"

/// The tool and its force on a page of `palpate share`.
namespace palpate {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// Half the visible width of the tool above its tip, m, found from both sides.
constexpr const char* tool_radius_script = R"((() => {
  const {page} = palpate, {gl, camera, canvas, surface} = page, {hand} = page.scene();
  page.picture.draw(camera, page.scene());
  const m = camera.matrix, pixel = new Uint8Array(4);
  const isTool = ([x, y, z]) => {
    const [a, b, , w] = [0, 1, 2, 3].map((r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]);
    gl.readPixels((1 + a / w) / 2 * canvas.width, (1 + b / w) / 2 * canvas.height, 1, 1, gl.RGBA,
                  gl.UNSIGNED_BYTE, pixel);
    return pixel[2] >= pixel[0] && pixel[0] > 50;  // neither tissue nor the background
  };
  const radius = hand.radius || 0.045 * surface.radius;
  const middle = add(hand.tip, hand.normal, radius);
  const aside = unit(cross(hand.axis, camera.back()));
  const widths = [-1, 1].map((side) => {
    let width = 0.05;
    while (width > 0 && !isTool(add(middle, aside, side * width))) width -= 0.0002;
    return width;
  });
  return (widths[0] + widths[1]) / 2;
})())";

/// How many dashes in the colours of certain and uncertain forces lie along the arrow's shaft, seen
/// from the side; and the colours of the text.
constexpr const char* arrow_script = R"((() => {
  const {page} = palpate, {gl, camera, canvas} = page, {hand, ...scene} = page.scene();
  const shown = {...hand, force: scaled(camera.up, 0.9 * facts.maxForce)};
  page.picture.draw(camera, {...scene, hand: shown});
  const long = 0.63 * page.surface.radius, m = camera.matrix, pixel = new Uint8Array(4);
  const colours = [], pieces = {blue: 0, amber: 0};
  for (let n = 0; n < 400; ++n) {
    const [x, y, z] = add(hand.tip, camera.up, n / 400 * long);
    const [a, b, , w] = [0, 1, 2, 3].map((r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]);
    gl.readPixels((1 + a / w) / 2 * canvas.width, (1 + b / w) / 2 * canvas.height, 1, 1, gl.RGBA,
                  gl.UNSIGNED_BYTE, pixel);
    const [red, green, blue] = pixel;
    colours.push(blue > 1.5 * green && green > red ? 'blue' :
                 red > green && green > 2 * blue ? 'amber' : '');
    if (colours[n] && colours[n] !== colours[n - 1]) ++pieces[colours[n]];
  }
  const colourOf = (id) => getComputedStyle(document.getElementById(id)).color;
  return {...pieces, bound: colourOf('bound'), about: colourOf('about'), hint: colourOf('hint'),
          words: document.getElementById('about').textContent};
})())";

struct SharePictureTest : test::SharedPage {
  static void press(test::Browser& browser) {
    const auto [x, y] = test::touchablePixel(browser);
    browser.mouse("mouseMoved", x, y);
    browser.mouse("mousePressed", x, y);
    settle(browser);
  }
  /// Returns whether the page soon shows the numbers of the latest answer.
  static bool isWritten(test::Browser& browser) {
    return browser.becomesTrue(
        "document.getElementById('about').textContent === "
        "palpate.page.words.about(palpate.touched)");
  }
};

TEST_F(SharePictureTest, AFingerHasItsTrueSize) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  open(browser);
  press(browser);
  EXPECT_NEAR(browser.valueOf(tool_radius_script).get<double>(), 0.02, 0.001);
}

TEST_F(SharePictureTest, AnActiveNodeIsTouchedByAThinTool) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  if (!makePage(test::TouchableBody(mesh, test::wholeSurface(mesh)))) return;
  test::Browser browser;
  open(browser);
  press(browser);
  const double radius = browser.valueOf("palpate.page.surface.radius");
  EXPECT_NEAR(browser.valueOf(tool_radius_script).get<double>(), 0.045 * radius, 0.005 * radius);
}

/// On a coarse lattice the bound is small near the middle; farther out a hand would notice the
/// error.
TEST_F(SharePictureTest, AForceTurnsAmberWhenAHandCouldNoticeItsError) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  if (!makePage(test::TouchableBody(mesh, test::wholeSurface(mesh), 0.1, 0.1))) return;
  test::Browser browser;
  open(browser);
  const auto share = [&] {
    const double force = browser.valueOf("Math.hypot(...palpate.touched.force)");
    return browser.valueOf("palpate.touched.bound").get<double>() / force;
  };
  browser.valueOf("palpate.page.setDepth(0.008)");
  press(browser);
  ASSERT_TRUE(isWritten(browser));
  ASSERT_LT(share(), noticeable_force_error);
  const json sure = browser.valueOf(arrow_script);
  EXPECT_EQ(sure.at("blue"), 1);
  EXPECT_EQ(sure.at("amber"), 0);
  EXPECT_EQ(sure.at("bound"), sure.at("hint"));
  EXPECT_THAT(sure.at("words").get<std::string>(), HasSubstr("8.0 mm from rest"));

  browser.valueOf("palpate.page.setDepth(0.025)");
  settle(browser);
  ASSERT_TRUE(isWritten(browser));
  ASSERT_GT(share(), noticeable_force_error);
  const json unsure = browser.valueOf(arrow_script);
  EXPECT_EQ(unsure.at("blue"), 0);
  EXPECT_GT(unsure.at("amber"), 1) << "dashed";
  EXPECT_NE(unsure.at("bound"), unsure.at("hint"));
  EXPECT_EQ(unsure.at("about"), unsure.at("bound"));
  EXPECT_EQ(unsure.at("words"), fmt::format("uncertain: ± {:.0f} %, a hand notices {:g} %",
                                            100 * share(), 100 * noticeable_force_error));
}

/// A hand does not notice an error that is smaller than the smallest force that it feels.
TEST_F(SharePictureTest, AnErrorThatAHandDoesNotFeelIsNotUncertain) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  open(browser);
  const auto isUncertain = [&](double force, double bound) {
    return browser
        .valueOf(fmt::format("isUncertain({{force: [0, 0, {}], bound: {}}})", force, bound))
        .get<bool>();
  };
  EXPECT_FALSE(isUncertain(1, 0.9 * noticeable_force_error));
  EXPECT_TRUE(isUncertain(1, 1.1 * noticeable_force_error));
  EXPECT_FALSE(isUncertain(0.001, 0.0002));
  EXPECT_EQ(browser.valueOf("isUncertain({force: [0, 0, 1], bound: NaN})"), false) << "no bound";
}

}  // namespace
}  // namespace palpate
