#include "viewer/picture/picture.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/expect_error.hpp"
#include "tests/support/pressed_body.hpp"
#include "tests/viewer/devices/polling.hpp"
#include "tests/viewer/haptics/touched_model.hpp"
#include "tests/viewer/picture/person.hpp"
#include "tests/viewer/picture/virtual_screen.hpp"
#include "viewer/picture/stage.hpp"
#include "viewer/picture/window.hpp"

namespace palpate {
namespace {

using Pixel = const std::uint8_t*;
using Colour = std::function<bool(Pixel)>;

bool isRed(Pixel p) { return p[0] > 110 && p[1] < 0.45 * p[0] && p[2] < 0.45 * p[0]; }
bool isTissue(Pixel p) { return p[0] > p[1] + 40 && p[0] > p[2] + 40 && p[0] < 200; }
bool isBlue(Pixel p) { return p[2] > 110 && p[0] < 0.4 * p[2] && p[1] < 0.75 * p[2]; }
bool isAmber(Pixel p) { return p[0] > 150 && p[1] > 0.5 * p[0] && p[2] < 0.35 * p[0]; }
bool isPurple(Pixel p) { return p[0] > p[1] + 40 && p[2] > p[1] + 40; }
bool isYellow(Pixel p) { return p[0] > p[2] + 60 && p[1] > p[2] + 60; }

/// The three bytes of a pixel; x from the left, y from the top.
const std::uint8_t* pixelOf(const Image& image, int x, int y) {
  return image.pixels.data() + 3 * (std::ptrdiff_t{y} * image.width + x);
}

/// How many pixels of the view, outside panels and legends, have a colour, and their mean position.
struct Spot {
  int count = 0;
  double x = 0, y = 0;
};
Spot find(const Image& image, const Colour& colour, int right = 980, int bottom = 400) {
  Spot spot;
  for (int y = 0; y < std::min(bottom, image.height); ++y)
    for (int x = 0; x < std::min(right, image.width); ++x)
      if (colour(pixelOf(image, x, y))) {
        ++spot.count;
        spot.x += x;
        spot.y += y;
      }
  spot.x /= std::max(spot.count, 1);
  spot.y /= std::max(spot.count, 1);
  return spot;
}

int differences(const Image& a, const Image& b, int right, int bottom) {
  int count = 0;
  for (int y = 0; y < bottom; ++y)
    for (int x = 0; x < right; ++x)
      if (!std::equal(pixelOf(a, x, y), pixelOf(a, x, y) + 3, pixelOf(b, x, y))) ++count;
  return count;
}

/// The topmost row of the side panel, from the top of the window, in which two pictures differ;
/// their height if there is none.
int firstChangeInPanel(const Image& a, const Image& b) {
  for (int y = 0; y < a.height; ++y)
    if (!std::equal(pixelOf(a, 996, y), pixelOf(a, 0, y + 1), pixelOf(b, 996, y))) return y;
  return a.height;
}

class PictureTest : public ::testing::Test {
 protected:
  /// The model is created once, because sealing and preparing take longer than most pictures.
  static const HapticModel& shared() {
    static const HapticModel model = test::tenNodeModel();
    return model;
  }
  /// The hand above the middle of the touchable surface, or pressed into it by `depth` metres.
  HapticState pressed(double depth) {
    HapticState state = pressedInto(model, depth);
    state.force = state.touch.force;
    return state;
  }
  HapticState pressedInto(const HapticModel& body, double depth) {
    HapticState state;
    state.time = ++time;
    state.tool = {0, 0, 0.2};
    Contact contact(body);
    contact.update(state.tool);
    const double top = body.surface().tree().nearest({0, 0, 0.2}).position.z();
    for (int step = 0; step <= 100 && depth > 0; ++step) {
      state.tool.z() = top + 1e-4 - (depth + 1e-4) * step / 100;
      contact.update(state.tool);
    }
    state.touch = contact.touch();
    return state;
  }
  /// smallCubeModel(), gripped at its top and pressed by half a millimetre.
  static HapticState pressedSmall(const HapticModel& small) {
    Contact contact(small, {.mode = ContactMode::glued});
    HapticState press;
    press.tool = {0.505, 0.005, 0.0099};
    contact.update(press.tool, false);
    press.touch = contact.update(press.tool, true);
    press.tool.z() = 0.00942;
    press.touch = contact.update(press.tool, true);
    EXPECT_TRUE(press.touch.touching);
    return press;
  }
  Image pictureOf(const HapticState& state, PictureOptions options = {},
                  const PictureStatus& status = {}) {
    options.vsync = false;
    Picture picture({&model}, options);
    picture.draw(state, status);
    return picture.grab();
  }

  /// Draws one frame with the mouse as the device. Returns whether it points at the body.
  static bool pointsAtTheBody(Picture& picture, const HapticState& state) {
    const std::optional<MouseTarget> target = picture.draw(state, {.mouse = true}).tool;
    return target && target->position.allFinite();
  }

  test::VirtualScreen screen;
  const HapticModel& model = shared();
  double time = 0;
};

TEST_F(PictureTest, ShowsTheBodyAndColoursThePressedPart) {
  const Image rest = pictureOf(pressed(0), {.ghost = false});
  EXPECT_GT(find(rest, isTissue).count, 5000);
  EXPECT_EQ(find(rest, isYellow).count, 0);
  const HapticState press = pressed(0.0048);
  ASSERT_TRUE(press.touch.touching);
  const Image dent = pictureOf(press, {.ghost = false});
  EXPECT_GT(find(dent, isYellow).count, 300);
}

/// Regression: after a deep press, all lighter presses were dark.
TEST_F(PictureTest, ResetsTheColourScaleWhenItShowsEverything) {
  Picture picture({&model}, {.vsync = false, .ghost = false});
  const HapticState press = pressed(0.0048);
  picture.draw(pressed(0.015), {});
  picture.draw(press, {});
  EXPECT_LT(find(picture.grab(), isYellow).count, 30);
  test::Person(screen.name(), "Palpate").press("f");
  for (int n = 0; n < 2; ++n) picture.draw(press, {});
  EXPECT_GT(find(picture.grab(), isYellow).count, 300);
}

TEST_F(PictureTest, BeginsTheColourScaleAgainAfterARelease) {
  Picture picture({&model}, {.vsync = false, .ghost = false});
  const HapticState deep = pressed(0.015), rest = pressed(0), press = pressed(0.0048);
  for (const HapticState* state : {&deep, &press}) picture.draw(*state, {});
  EXPECT_LT(find(picture.grab(), isYellow).count, 30);
  for (const HapticState* state : {&rest, &press}) picture.draw(*state, {});
  EXPECT_GT(find(picture.grab(), isYellow).count, 300) << "the colour of the end of the scale";
}

TEST_F(PictureTest, ShowsTheGhostOnlyWhereTheBodyIsDeformed) {
  const HapticState rest = pressed(0), press = pressed(0.012);
  EXPECT_EQ(
      differences(pictureOf(rest, {.ghost = true}), pictureOf(rest, {.ghost = false}), 980, 622),
      0);
  EXPECT_GT(
      differences(pictureOf(press, {.ghost = true}), pictureOf(press, {.ghost = false}), 980, 622),
      300);
}

TEST_F(PictureTest, ShowsAnArrowWhenThereIsAForce) {
  HapticState state = pressed(0);
  state.tool = {0, 0, 0.055};
  EXPECT_EQ(find(pictureOf(state), isBlue).count, 0);
  state.force = {0, 0, 2};
  EXPECT_GT(find(pictureOf(state), isBlue).count, 100);
}

TEST_F(PictureTest, ShowsASecondFingerWithItsDentAndForce) {
  HapticState held = pressed(0);
  const Image rest = pictureOf(held, {.ghost = false});
  const Eigen::Vector3d place = model.surface().nearestTouchable({0, 0, 0.2}).position;
  held.hold = Hold{place, {0, 0, -0.0048}};
  const Image dent = pictureOf(held, {.ghost = false});
  EXPECT_GT(differences(rest, dent, 980, 622), 10000) << "the body is deformed without the hand";
  held.hold_force = {{0, 0, 0.4}, 0.01};
  const Image pushing = pictureOf(held, {.ghost = false});
  EXPECT_GT(differences(dent, pushing, 980, 400), 200) << "an arrow and a label";
  EXPECT_LT(firstChangeInPanel(dent, pushing), dent.height);
  held.hold_force.error_bound = 0.3;
  EXPECT_GT(find(pictureOf(held, {.ghost = false}), isAmber).count, 50);
}

TEST_F(PictureTest, ShowsAnUncertainForceInAmber) {
  HapticState state = pressed(0.004);
  ASSERT_TRUE(state.touch.touching);
  state.touch.error_bound = 0.3 * state.touch.force.norm();
  state.force = state.touch.force.normalized();
  const PictureOptions options{.ghost = false};
  EXPECT_GT(find(pictureOf(state, options), isAmber).count, 100);
  state.touch.error_bound = 0;
  EXPECT_EQ(find(pictureOf(state, options), isAmber).count, 0);
}

TEST_F(PictureTest, ShowsTheLatticeByTag) {
  const HapticState state = pressed(0);
  const auto green = [](Pixel p) { return p[0] == 38 && p[1] == 140 && p[2] == 72; };
  EXPECT_EQ(find(pictureOf(state), green, 980, 500).count, 0);
  EXPECT_GT(find(pictureOf(state, {.lattice = true}), green, 980, 500).count, 16 * 10);
}

TEST_F(PictureTest, FillsItsPanelsAndShowsTroubleInRed) {
  Picture picture({&model}, {.vsync = false});
  const HapticState state = pressed(0);
  picture.draw(state, {});
  const Image calm = picture.grab();
  PictureStatus status;
  status.trouble = "the device is unplugged; plug it in again";
  picture.draw(state, status);
  const Image troubled = picture.grab();
  EXPECT_GT(find(troubled, isRed, 400, 60).count, find(calm, isRed, 400, 60).count + 200);
  const auto ink = [](Pixel p) { return p[0] < 120 && p[1] < 120 && p[2] < 120; };
  EXPECT_GT(find(calm, ink, 1280, 800).count - find(calm, ink, 980, 800).count, 1000)
      << "numbers at the side";
}

/// A person who presses looks for force, error and depth, and for what changes the force.
TEST_F(PictureTest, ListsForceErrorDepthAndLimitsAboveEverythingElse) {
  HapticState usual = pressed(0.004);
  usual.touch.error_bound = 0.01;
  const Image before = pictureOf(usual);
  const auto rowOf = [&](const HapticState& state, const PictureStatus& status = {}) {
    return firstChangeInPanel(before, pictureOf(state, {}, status));
  };
  HapticState stronger = usual, uncertain = usual, limited = usual, by_another_method = usual,
              active = usual;
  stronger.force *= 2;
  uncertain.touch.error_bound = 0.02;
  HapticState deeper = pressed(0.008);
  deeper.force = usual.force;
  deeper.touch.error_bound = usual.touch.error_bound;
  limited.guards = 1;
  by_another_method.method = 1;
  active.passivity = 1;
  const std::vector<int> rows = {rowOf(stronger),
                                 rowOf(uncertain),
                                 rowOf(deeper),
                                 rowOf(limited),
                                 rowOf(by_another_method),
                                 rowOf(active),
                                 rowOf(usual, {.device = "a device"})};
  EXPECT_TRUE(std::ranges::adjacent_find(rows, std::ranges::greater_equal()) == rows.end())
      << testing::PrintToString(rows);
  EXPECT_LT(rows.back(), before.height);
}

TEST_F(PictureTest, SwitchesBetweenModelsThatShareTheWindow) {
  const HapticModel other = test::cubeModel();
  Picture picture({&model, &other}, {.vsync = false});
  HapticState state = pressed(0);
  picture.draw(state, {});
  const Image first = picture.grab();
  state.model = 1;
  picture.draw(state, {});
  EXPECT_GT(differences(first, picture.grab(), 980, 622), 20000);
}

TEST_F(PictureTest, ShowsABodyOfAnotherSizeAsLargeAsTheFirst) {
  const HapticModel small = test::smallCubeModel();
  Picture picture({&model, &small}, {.vsync = false});
  HapticState state = pressed(0);
  picture.draw(state, {});
  test::Person(screen.name(), "Palpate").press("b");
  for (int n = 0; n < 3; ++n) picture.draw(state, {});
  const Image both = picture.grab();
  const int left = find(both, isTissue, 494).count;
  EXPECT_GT(left, 2000);
  EXPECT_GT(find(both, isTissue).count - left, 2000) << "the other body";
  test::Person(screen.name(), "Palpate").press("b");
  state.model = 1;
  for (int n = 0; n < 3; ++n) picture.draw(state, {});
  EXPECT_GT(find(picture.grab(), isTissue).count, 5000);
}

/// Regression: the scale of a body ten times as large was kept.
TEST_F(PictureTest, ColoursASmallBodyAsBeforeOnceALargeOneIsGone) {
  const HapticModel small = test::smallCubeModel();
  Picture picture({&small, &model}, {.vsync = false, .ghost = false});
  HapticState rest;
  rest.tool = {0.505, 0.005, 0.05};
  picture.draw(rest, {});
  test::Person person(screen.name(), "Palpate");
  for (int n = 0; n < 2; ++n) {
    person.press("b");
    for (int drawn = 0; drawn < 3; ++drawn) picture.draw(rest, {});
  }
  picture.draw(pressedSmall(small), {});
  EXPECT_GT(find(picture.grab(), isYellow).count, 300);
}

TEST_F(PictureTest, ShowsAnotherDatasetInTheSameTouchAlongside) {
  const auto bluesAfterB = [&](const HapticModel& other) {
    Picture picture({&model, &other}, {.vsync = false});
    const HapticState state = pressed(0.01);
    picture.draw(state, {});
    test::Person(screen.name(), "Palpate").press("b");
    for (int n = 0; n < 3; ++n) picture.draw(state, {});
    const Image image = picture.grab();
    const int left = find(image, isBlue, 494).count;
    return std::pair(left, find(image, isBlue).count - left);
  };
  const HapticModel same = test::tenNodeModel(), another = test::cubeModel();
  const auto [left, right] = bluesAfterB(same);
  EXPECT_GT(left, 20) << "the arrow of the touched dataset";
  EXPECT_NEAR(right, left, 0.2 * left) << "and the other dataset's";
  EXPECT_EQ(bluesAfterB(another).second, 0) << "the other body is not touched";
}

TEST_F(PictureTest, WantsToCloseWhenItsWindowIsClosed) {
  Picture picture({&model}, {.vsync = false});
  picture.draw(pressed(0), {});
  EXPECT_FALSE(picture.wantsClose());
  test::Person(screen.name(), "Palpate").closeWindow();
  picture.draw(pressed(0), {});
  EXPECT_TRUE(picture.wantsClose());
}

TEST_F(PictureTest, PassesOnCommandsByKeys) {
  Picture picture({&model}, {.vsync = false});
  const HapticState state = pressed(0);
  picture.draw(state, {});
  test::Person person(screen.name(), "Palpate");
  const auto after = [&](const char* key) {
    person.press(key);
    return picture.draw(state, {});
  };
  EXPECT_TRUE(after("r").release);
  EXPECT_TRUE(after("t").hold);
  EXPECT_TRUE(after("space").pause);
  EXPECT_TRUE(after("F5").reload);
  EXPECT_TRUE(after("q").quit);
  const PictureRequests method = after("m");
  ASSERT_TRUE(method.use);
  EXPECT_EQ(method.use->method, 1);
  EXPECT_FALSE(method.release || method.pause || method.quit);
}

TEST_F(PictureTest, MovesTheToolToThePointedPlaceAndPresses) {
  Picture picture({&model}, {.vsync = false});
  const HapticState state = pressed(0);
  const PictureStatus mouse{.mouse = true};
  picture.draw(state, mouse);
  test::Person person(screen.name(), "Palpate");
  const auto tool = [&] {
    const std::optional<MouseTarget> target = picture.draw(state, mouse).tool;
    return target ? target->position : Eigen::Vector3d::Zero();
  };
  const auto gap = [&](const Eigen::Vector3d& point) {
    const NearestPoint nearest = model.surface().tree().nearest(point);
    return nearest.outside ? nearest.distance : -nearest.distance;
  };
  EXPECT_FALSE(tool().allFinite());
  person.pointAt(490, 311);  // the middle of the view
  ASSERT_TRUE(test::eventually([&] { return tool().allFinite(); }));
  EXPECT_GT(gap(tool()), 0);
  EXPECT_LT(gap(tool()), 0.01);
  person.holdButton();
  EXPECT_TRUE(test::eventually([&] { return gap(tool()) < -0.005; }));
  person.letButtonGo();
  person.pointAt(20, 20);
  EXPECT_TRUE(test::eventually([&] { return !tool().allFinite(); }));
  EXPECT_FALSE(picture.draw(state, {}).tool) << "another device";
}

TEST_F(PictureTest, MarksPressablePlacesByARingAndAHint) {
  Picture picture({&model}, {.vsync = false});
  HapticState state = pressed(0);
  state.reading.status = DeviceStatus::away;
  test::Person person(screen.name(), "Palpate");
  person.pointAt(20, 20);
  ASSERT_TRUE(test::eventually([&] { return !pointsAtTheBody(picture, state); }));
  const Image beside = picture.grab();
  person.pointAt(490, 311);
  ASSERT_TRUE(test::eventually([&] { return pointsAtTheBody(picture, state); }));
  const Image over = picture.grab();
  EXPECT_GT(differences(beside, over, 980, 560), 50) << "a ring";
  EXPECT_GT(differences(beside, over, 980, 622), differences(beside, over, 980, 560) + 200)
      << "another hint";
}

TEST_F(PictureTest, OffersAMethodWhenItIsPrepared) {
  const test::TemporaryDirectory directory;
  test::TouchableBody(test::cubeMesh(0.1, 4), {{112}, {113, 2}}).seal(directory / "body.h5");
  HapticModel half(Dataset(directory / "body.h5"), {.prepare = false});
  half.prepare(0);
  Picture picture({&half}, {.vsync = false});
  test::Person person(screen.name(), "Palpate");
  HapticState state;
  picture.draw(state, {});
  const Image before = picture.grab();
  person.press("m");
  EXPECT_FALSE(picture.draw(state, {}).use);
  half.prepare(1);
  person.press("m");
  EXPECT_TRUE(picture.draw(state, {}).use);
  EXPECT_GT(differences(before, picture.grab(), 1280, 500), 100) << "it said what was missing";
}

TEST_F(PictureTest, ShowsTheLatticeByError) {
  Picture picture({&model}, {.vsync = false, .lattice = true});
  test::Person person(screen.name(), "Palpate");
  const HapticState state = pressed(0);
  picture.draw(state, {});
  const Image tags = picture.grab();
  person.press("e");
  picture.draw(state, {});  // handles the key
  picture.draw(state, {});
  EXPECT_GT(differences(tags, picture.grab(), 980, 622), 1000);
}

TEST_F(PictureTest, ShowsTheRequestedColours) {
  Picture picture({&model}, {.vsync = false, .ghost = false});
  test::Person person(screen.name(), "Palpate");
  const HapticState state = pressed(0.0048);
  const auto after = [&](const char* key) {
    if (key != nullptr) person.press(key);
    picture.draw(state, {});
    picture.draw(state, {});
    return picture.grab();
  };
  const Image displacement = after(nullptr), error = after("c");
  after("c");
  const Image tissue = after("c");
  const auto isLegend = [](Pixel p) { return isYellow(p) && p[0] > 240; };
  const auto legend = [&](const Image& image) { return find(image, isLegend, 40, 622).count; };
  EXPECT_GT(legend(displacement), 10);
  EXPECT_GT(legend(error), 10);
  EXPECT_EQ(legend(tissue), 0) << "nothing shown needs a legend";
  EXPECT_EQ(find(tissue, isYellow, 980, 400).count, 0);
  EXPECT_GT(differences(displacement, error, 980, 622), 5000);
}

/// Colours by pressure: the second choice of key C after displacement.
class PressurePictureTest : public PictureTest {
 protected:
  static HapticModel blob(double factor, double linear_below) {
    const Mesh mesh = test::blobMesh(6);
    const std::vector<std::int32_t>& top = mesh.node_groups.at("zmax");
    const auto from_middle = [&](std::int32_t node) {
      return mesh.nodes[static_cast<std::size_t>(node)].head<2>().norm();
    };
    const std::int32_t node = *std::ranges::min_element(top, {}, from_middle);
    const test::TemporaryDirectory directory;
    test::PressedBody(mesh, {{node}}, factor, linear_below).seal(directory / "body.h5");
    return HapticModel(Dataset(directory / "body.h5"), {.reach = 0.06, .pressures = true});
  }
  static HapticModel blob(double factor = 1) {
    return blob(factor, -std::numeric_limits<double>::infinity());
  }
  Image coloured(const std::vector<const HapticModel*>& models, const HapticState& state,
                 const std::string& keys) {
    Picture picture(models, {.vsync = false, .ghost = false});
    picture.draw(state, {});
    test::Person person(screen.name(), "Palpate");
    for (const char key : keys) {
      person.press(std::string(1, key).c_str());
      picture.draw(state, {});
    }
    // The other dataset appears in the first frame, its scale in the second.
    for (int n = 0; n < 2; ++n) picture.draw(state, {});
    return picture.grab();
  }
};

TEST_F(PressurePictureTest, ShowsCompressionUnderTheToolInPressureColours) {
  const HapticModel body = blob();
  const HapticState state = pressedInto(body, 0.005);
  ASSERT_TRUE(state.touch.touching);
  const Image displacement = coloured({&body}, state, ""),
              pressure = coloured({&body}, state, "cc");
  EXPECT_GT(differences(displacement, pressure, 980, 400), 5000);
  EXPECT_GT(find(pressure, isPurple).count, find(displacement, isPurple).count + 300);
  const auto bar = [&](const Image& image) { return find(image, isPurple, 32, 622).count; };
  EXPECT_GT(bar(pressure), bar(displacement) + 100) << "and its legend";
}

TEST_F(PressurePictureTest, LeavesTissueColourWhereThereIsNoPressure) {
  const HapticModel body = blob(), layered = blob(1, 0.0);
  const HapticState state = pressedInto(body, 0.005);
  const Image whole = coloured({&body}, state, "cc"), half = coloured({&layered}, state, "cc");
  EXPECT_GT(find(half, isTissue).count, find(whole, isTissue).count + 800) << "hatched there";
}

TEST_F(PressurePictureTest, HasOneScaleForTwoDatasetsSideBySide) {
  const HapticModel body = blob(), same = blob(), harder = blob(8);
  const HapticState state = pressedInto(body, 0.005);
  const auto left = [&](const HapticModel& other) {
    return find(coloured({&body, &other}, state, "ccb"), isPurple, 494).count;
  };
  EXPECT_LT(left(harder), 0.5 * left(same)) << "pale compared with eight times the pressure";
}

TEST_F(PictureTest, ShowsAToolInsideTheBodyThroughIt) {
  HapticState state = pressed(0);
  state.tool = {0, 0, 0};
  const Image inside = pictureOf(state, {.ghost = false});
  state.tool = {0, 0, 5};  // out of sight
  const Image without = pictureOf(state, {.ghost = false});
  EXPECT_GT(differences(inside, without, 980, 622), 60);
}

TEST_F(PictureTest, FitsSmallAndHugeWindows) {
  const HapticState state = pressed(0.0048);
  for (const auto& [width, height] : {std::pair{640, 400}, std::pair{3840, 2160}}) {
    const Image image =
        pictureOf(state, {.width = width, .height = height, .visible = false, .ghost = false});
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.height, height);
    const Spot body = find(image, isTissue, width * 2 / 3, height * 3 / 4);
    EXPECT_GT(body.count, width * height / 100) << width;
  }
}

TEST(Picture, WithoutADisplaySaysWhatToDo) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const HapticModel model = test::cubeModel();
  test::expectError(ExitCode::failed, [&] { Picture picture({&model}); },
                    {"display", "--headless", "xvfb-run"});
}

/// A stage in its own window, seen from +z, y up; tests look at its pixels.
class StageTest : public ::testing::Test {
 protected:
  StageTest() : window("Stage", 400, 400, true, false) {
    shot.camera.frame(Eigen::Vector3d::Zero(), 0.1, Eigen::Vector3d::UnitZ(),
                      Eigen::Vector3d::UnitY(), 1);
  }
  Image render() {
    stage.render(shot, {400, 400, 0, 0, 400, 400});
    return readPixels(400, 400);
  }

  test::VirtualScreen screen;
  Window window;
  Stage stage;
  Shot shot;
};

TEST_F(StageTest, PointsTheArrowAlongTheForce) {
  EXPECT_EQ(find(render(), isBlue, 400, 400).count, 0);
  for (const Eigen::Vector3d& arrow :
       {Eigen::Vector3d(0.06, 0, 0), Eigen::Vector3d(-0.06, 0, 0), Eigen::Vector3d(0, 0.06, 0),
        Eigen::Vector3d(0.03, -0.04, 0)}) {
    shot.tool.arrow = arrow;
    const Spot spot = find(render(), isBlue, 400, 400);
    ASSERT_GT(spot.count, 50);
    const Eigen::Vector2d seen(spot.x - 199.5, 199.5 - spot.y);
    EXPECT_GT(seen.normalized().dot(arrow.head<2>().normalized()), 0.98) << arrow.transpose();
    EXPECT_GT(seen.norm(), 20);
  }
}

TEST_F(StageTest, DrawsTheSecondFingerInAnotherShade) {
  const auto isGreen = [](Pixel p) { return p[1] > p[0] + 15 && p[1] > p[2] + 8; };
  shot.tool.shape = {ToolForm::finger, 0.02};
  shot.tool.pose.tip = {-0.05, 0, 0};
  EXPECT_EQ(find(render(), isGreen, 400, 400).count, 0);
  shot.held = shot.tool;
  shot.held->holds = true;
  shot.held->pose.tip = {0.05, 0, 0};
  const Spot spot = find(render(), isGreen, 400, 400);
  EXPECT_GT(spot.count, 200);
  EXPECT_GT(spot.x, 200) << "only the second one";
}

TEST_F(StageTest, DashesTheArrowOfAnUncertainForce) {
  /// How many dashes of a colour there are along the middle of the picture.
  const auto pieces = [&](bool uncertain, bool (*colour)(Pixel)) {
    shot.tool.arrow = {0.08, 0, 0};
    shot.tool.uncertain = uncertain;
    const Image image = render();
    int count = 0;
    for (int x = 1; x < 400; ++x)
      count += colour(pixelOf(image, x, 200)) && !colour(pixelOf(image, x - 1, 200)) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(pieces(false, isBlue), 1);
  EXPECT_GT(pieces(true, isAmber), 1);
}

TEST_F(StageTest, DrawsDotsAtTheirPlacesInTheirColours) {
  const std::vector<LatticeDot> dots = {{{0.03, 0, 0}, colourOf(Tag::failed)},
                                        {{-0.03, 0.02, 0}, colourOf(Tag::expandable)}};
  LatticeView lattice;
  shot.lattice = &lattice;
  lattice.setDots(dots, {0, 0.01, 0}, 6);
  const auto at = [&](const Image& image, const LatticeDot& dot) {
    const Eigen::Vector3d place =
        shot.camera.project(dot.displacement + Eigen::Vector3d(0, 0.01, 0));
    Pixel p = pixelOf(image, static_cast<int>(200 + 400 * place.x()),
                      static_cast<int>(200 - 400 * place.y()));
    return std::array<double, 3>{static_cast<double>(p[0]), static_cast<double>(p[1]),
                                 static_cast<double>(p[2])};
  };
  const Image without = render();
  lattice.show(true);
  const Image with = render();
  for (const LatticeDot& dot : dots) {
    EXPECT_NE(at(without, dot), dot.colour);
    EXPECT_EQ(at(with, dot), dot.colour);
  }
}

}  // namespace
}  // namespace palpate
