#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/finger_body.hpp"
#include "tests/system/shared_page.hpp"
#include "tests/system/touchable_pixel.hpp"

/// A page of `palpate share` on a phone, and in small and huge windows.
namespace palpate {
namespace {

using nlohmann::json;
using Window = test::Browser::Window;

constexpr Window phone = {360, 640, 3, true};

/// The positions of all vertices on the page, and the rectangles of its parts: {left, top, right,
/// bottom}.
constexpr const char* layout_script = R"((() => {
  const rectangle = (element) => {
    const r = element.getBoundingClientRect();
    return [r.left, r.top, r.right, r.bottom];
  };
  const {surface, camera: {matrix: m}} = palpate.page, places = [];
  for (let v = 0; v < surface.count; ++v) {
    const [x, y, z] = surface.rest.subarray(3 * v, 3 * v + 3);
    const [a, b, , w] = [0, 1, 2, 3].map((r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]);
    places.push([(1 + a / w) / 2 * innerWidth, (1 - b / w) / 2 * innerHeight]);
  }
  const of = (id) => rectangle(document.getElementById(id));
  return {
    places, words: of('words'), numbers: of('numbers'),
    parts: ['felt', 'plot', 'about', 'depths'].map(of), slider: of('depth'),
    letters: [...document.querySelectorAll('#hint, #about, #depths')].map(
        (element) => parseFloat(getComputedStyle(element).fontSize)),
    wider: document.documentElement.scrollWidth > innerWidth ||
        [...document.querySelectorAll('#numbers *')].some((e) => e.scrollWidth > e.clientWidth + 1 &&
            getComputedStyle(e).display !== 'inline')
  };
})())";

bool overlap(const json& a, const json& b) {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}
bool isIn(const json& place, const json& r) {
  return place[0] > r[0] && place[0] < r[2] && place[1] > r[1] && place[1] < r[3];
}

struct ShareWindowsTest : test::SharedPage {
  /// Nothing overlaps or exceeds the window, and the organ is in the middle of the free space.
  static void expectOrder(test::Browser& browser, const Window& window) {
    SCOPED_TRACE(fmt::format("{} x {} at {}", window.width, window.height, window.scale));
    const json seen = browser.valueOf(layout_script);
    const json whole = {0, 0, window.width, window.height};
    EXPECT_FALSE(overlap(seen["words"], seen["numbers"]));
    for (const char* part : {"words", "numbers"})
      for (std::size_t side = 0; side < 2; ++side) {
        EXPECT_GE(seen[part][side], whole[side]) << part;
        EXPECT_LE(seen[part][2 + side], whole[2 + side]) << part;
      }
    const json& parts = seen["parts"];
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) EXPECT_FALSE(overlap(parts[a], parts[b])) << a << b;
    EXPECT_EQ(seen["wider"], false);
    for (const json& size : seen["letters"]) EXPECT_GE(size, 12.5);
    expectOrganInTheOpen(seen, whole);
  }
  static void expectOrganInTheOpen(const json& seen, const json& whole) {
    double low_x = 1e9, high_x = 0, low_y = 1e9, high_y = 0;
    int hidden = 0;
    for (const json& place : seen["places"]) {
      EXPECT_TRUE(isIn(place, whole)) << place;
      if (isIn(place, seen["words"]) || isIn(place, seen["numbers"])) ++hidden;
      low_x = std::min<double>(low_x, place[0]), high_x = std::max<double>(high_x, place[0]);
      low_y = std::min<double>(low_y, place[1]), high_y = std::max<double>(high_y, place[1]);
    }
    EXPECT_EQ(hidden, 0);
    const double width = whole[2], height = whole[3];
    EXPECT_GT(std::max((high_x - low_x) / width, (high_y - low_y) / height), 0.35);
    // Below the text and above the numbers if these are wide, otherwise in the middle of the
    // window.
    const bool is_narrow =
        seen["numbers"][2].get<double>() - seen["numbers"][0].get<double>() > 0.8 * width;
    const double top = is_narrow ? seen["words"][3].get<double>() : 0,
                 bottom = is_narrow ? seen["numbers"][1].get<double>() : height;
    EXPECT_NEAR((low_x + high_x) / 2, width / 2, 0.06 * width);
    EXPECT_NEAR((low_y + high_y) / 2, (top + bottom) / 2, 0.06 * height);
  }
};

TEST_F(ShareWindowsTest, NothingOverlapsAndTheOrganIsInTheMiddle) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  for (const Window& window :
       {Window{320, 480}, phone, Window{1280, 800}, Window{3840, 2160}, Window{3840, 2160, 2}}) {
    browser.show(window);
    open(browser);
    expectOrder(browser, window);
  }
}

TEST_F(ShareWindowsTest, ThePageFollowsTheSizeOfItsWindow) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  open(browser);
  for (const Window& window : {Window{320, 480}, Window{1280, 800}}) {
    browser.show(window);
    ASSERT_TRUE(browser.becomesTrue("palpate.page.whole.width === innerWidth && innerWidth === " +
                                    std::to_string(window.width) + " && !palpate.page.changed"));
    expectOrder(browser, window);
  }
}

TEST_F(ShareWindowsTest, OnAPhoneOneFingerPressesAndTheSliderPressesDeeper) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  browser.show(phone);
  open(browser);
  const auto place = test::touchablePixel(browser);
  browser.touch("touchStart", {place});
  settle(browser);
  const double force = browser.valueOf("Math.hypot(...palpate.touched.force)");
  EXPECT_GT(force, 0.1);
  expectOrder(browser, phone);
  const json slider = browser.valueOf(layout_script)["slider"];
  EXPECT_GE(slider[3].get<double>() - slider[1].get<double>(), 40) << "a finger finds it";
  const std::pair<double, double> far_end = {
      slider[2].get<double>() - 3, (slider[1].get<double>() + slider[3].get<double>()) / 2};
  browser.touch("touchStart", {place, far_end});
  browser.touch("touchMove", {place, far_end});
  ASSERT_TRUE(browser.becomesTrue("palpate.page.hand.wanted > 0.015"));
  settle(browser);
  EXPECT_GT(browser.valueOf("Math.hypot(...palpate.touched.force)").get<double>(), force);
  browser.touch("touchEnd");
  EXPECT_TRUE(browser.becomesTrue("palpate.touched === null"));
}

TEST_F(ShareWindowsTest, OnAPhoneTwoFingersZoomAndTurnWithoutPressing) {
  if (!makePage(test::FingerBody())) return;
  test::Browser browser;
  browser.show(phone);
  open(browser);
  const auto [x, y] = test::touchablePixel(browser);
  browser.touch("touchStart", {{x, y}});
  settle(browser);
  browser.touch("touchStart", {{x, y}, {x + 60, y}});
  ASSERT_TRUE(browser.becomesTrue("palpate.touched === null")) << "the second lets go";

  const json before = browser.valueOf("({...palpate.page.camera})");
  browser.touch("touchMove", {{x, y}, {x + 75, y}});
  browser.touch("touchMove", {{x - 15, y}, {x + 75, y}});
  ASSERT_TRUE(browser.becomesTrue("palpate.page.camera.distance < " +
                                  std::to_string(0.8 * before["distance"].get<double>())));
  EXPECT_NEAR(browser.valueOf("palpate.page.camera.distance").get<double>(),
              before["distance"].get<double>() * 60 / 90, 0.02 * before["distance"].get<double>());
  EXPECT_NEAR(browser.valueOf("palpate.page.camera.turn").get<double>(), before["turn"], 1e-3);

  browser.touch("touchMove", {{x + 25, y}, {x + 115, y}});
  ASSERT_TRUE(browser.becomesTrue("palpate.page.camera.turn < " +
                                  std::to_string(before["turn"].get<double>() - 0.2)));
  EXPECT_NEAR(browser.valueOf("palpate.page.camera.distance").get<double>(),
              before["distance"].get<double>() * 60 / 90, 0.02 * before["distance"].get<double>());
  browser.touch("touchEnd");
  EXPECT_TRUE(browser.becomesTrue("palpate.page.pointers.size === 0 && !palpate.touched"));
}

}  // namespace
}  // namespace palpate
