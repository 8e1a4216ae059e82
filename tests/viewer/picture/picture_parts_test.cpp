#include <gtest/gtest.h>
#include <stb_image.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "tests/support/expect_error.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/picture/force_history.hpp"
#include "viewer/picture/guard_lamps.hpp"
#include "viewer/picture/image.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/window.hpp"

namespace palpate {
namespace {

Image chequered() {
  Image image{5, 3, std::vector<std::uint8_t>(45)};
  for (std::size_t n = 0; n < image.pixels.size(); ++n)
    image.pixels[n] = static_cast<std::uint8_t>(5 * n);
  return image;
}

TEST(Image, IsReadBackAsItWasWritten) {
  const test::TemporaryDirectory directory;
  const Image image = chequered();
  writePng(image, directory / "a.png");
  int width = 0, height = 0, channels = 0;
  std::uint8_t* read = stbi_load((directory / "a.png").c_str(), &width, &height, &channels, 3);
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(std::vector<std::uint8_t>(read, read + 45), image.pixels);
  stbi_image_free(read);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 3);
  EXPECT_FALSE(std::filesystem::exists(directory / "a.png.tmp"));
}

TEST(Image, NamesAnUnwritableFileAndLeavesNothing) {
  const test::TemporaryDirectory directory;
  test::expectError(ExitCode::failed, [&] { writePng(chequered(), directory / "no" / "a.png"); },
                    {"no/a.png", "No such file"});
  std::filesystem::create_directories(directory / "b.png" / "full");
  test::expectError(ExitCode::failed, [&] { writePng(chequered(), directory / "b.png"); },
                    {"b.png"});
  EXPECT_FALSE(std::filesystem::exists(directory / "b.png.tmp"));
}

TEST(VideoFrames, AreNumberedFromOneAndNeverMixedWithAnotherRun) {
  const test::TemporaryDirectory directory;
  VideoFrames frames(directory / "film");
  frames.add(chequered());
  frames.add(chequered());
  EXPECT_EQ(frames.count(), 2);
  EXPECT_TRUE(std::filesystem::exists(directory / "film" / "frame-000001.png"));
  EXPECT_TRUE(std::filesystem::exists(directory / "film" / "frame-000002.png"));
  test::expectBadInput([&] { VideoFrames again(directory / "film"); }, {"film", "frame-00000"});
}

TEST(ForceHistory, KeepsFiveSecondsAndRestartsWhenTimeDoes) {
  ForceHistory history;
  for (int n = 0; n <= 600; ++n)
    history.add(n / 60.0, Eigen::Vector3d(0, n == 100 ? 9 : n * 1e-3, 0), 0);
  EXPECT_NEAR(history.samples().front().time, 5, 1e-9);
  EXPECT_NEAR(history.samples().back().time, 10, 1e-9);
  EXPECT_NEAR(history.largest(), 0.6, 1e-6) << "the 9 N were too long ago";
  const std::size_t size = history.samples().size();
  history.add(10, Eigen::Vector3d::Zero(), 0);
  EXPECT_EQ(history.samples().size(), size) << "the same tick twice";
  history.add(0.5, Eigen::Vector3d(3, 4, 0), 0);
  EXPECT_EQ(history.samples().size(), 1U);
  EXPECT_NEAR(history.largest(), 5, 1e-6);
}

TEST(ForceHistory, ForgetsTheOldestWhenPicturesComeTooFast) {
  ForceHistory history;
  for (int n = 0; n < 5000; ++n) history.add(1e-3 * n, Eigen::Vector3d::UnitX(), 0);
  EXPECT_LE(history.samples().size(), 1024U);
  EXPECT_NEAR(history.samples().back().time, 4.999, 1e-9);
  for (std::size_t n = 1; n < history.samples().size(); ++n)
    EXPECT_GT(history.samples()[n].time, history.samples()[n - 1].time);
}

TEST(ForceHistory, IncludesBoundsUpToTheForceItself) {
  ForceHistory history;
  history.add(1, Eigen::Vector3d(3, 4, 0), 0.5);
  EXPECT_NEAR(history.largest(), 5.5, 1e-6);
  EXPECT_FLOAT_EQ(history.samples().back().bound, 0.5F);
  history.add(2, Eigen::Vector3d(0, 1, 0), 1000);
  history.add(3, Eigen::Vector3d(0, 1, 0), std::numeric_limits<double>::quiet_NaN());
  EXPECT_NEAR(history.largest(), 5.5, 1e-6);
}

TEST(ScreenScale, IsInQuartersAndNeverTooSmallOrHuge) {
  EXPECT_EQ(roundedScale(1.04), 1);
  EXPECT_EQ(roundedScale(1.5), 1.5);
  EXPECT_EQ(roundedScale(1.7), 1.75);
  EXPECT_EQ(roundedScale(0.6), 1);
  EXPECT_EQ(roundedScale(40), 4);
  EXPECT_EQ(roundedScale(std::nan("")), 1);
}

TEST(GuardLamps, StayLitForHalfASecondAndCatchEventsBetweenFrames) {
  GuardLamps lamps;
  std::array<std::uint64_t, guard_count> ticks = {};
  lamps.update(10, static_cast<std::uint32_t>(Guarded::clamped), ticks);
  EXPECT_TRUE(lamps.lit(2));
  EXPECT_FALSE(lamps.lit(3));
  ticks[3] = 1;  // acted and ended before the frame
  lamps.update(10.3, 0, ticks);
  EXPECT_TRUE(lamps.lit(2));
  EXPECT_TRUE(lamps.lit(3));
  lamps.update(10.6, 0, ticks);
  EXPECT_FALSE(lamps.lit(2));
  EXPECT_TRUE(lamps.lit(3));
}

TEST(LatticeDots, AreColouredByTagAndCutToOneLayer) {
  const test::SampleDataset sample;
  const SpaceTable& tip = sample.spaces[0];
  const std::vector<LatticeDot> all = tagDots(tip, std::nullopt);
  ASSERT_EQ(all.size(), tip.points.size());
  std::map<std::array<double, 3>, int> counts;
  for (const LatticeDot& dot : all) ++counts[dot.colour];
  EXPECT_EQ(counts[colourOf(Tag::failed)], 1);
  EXPECT_EQ(counts[colourOf(Tag::unknown)], 1);
  EXPECT_EQ(counts[colourOf(Tag::terminating)], 1);
  EXPECT_EQ(counts[colourOf(Tag::expandable)], static_cast<int>(all.size()) - 3);
  const std::vector<LatticeDot> layer = tagDots(tip, LatticeCut{1, 0.01});
  EXPECT_GT(layer.size(), 4U);
  for (const LatticeDot& dot : layer) EXPECT_NEAR(dot.displacement.y(), 0.01, 1e-12);
}

TEST(LatticeDots, ShowTheErrorBoundOfCellMiddles) {
  const test::SampleDataset sample;
  const SpaceTable& space = sample.spaces[1];
  const auto field = makeForceField("potential", space);
  const std::vector<CellError> errors = cellErrors(space, *field);
  ASSERT_FALSE(errors.empty());
  for (const CellError& cell : errors) {
    EXPECT_LE(cell.displacement.norm(), space.lattice.radius());
    const ForceSample answer = field->evaluate(cell.displacement);
    EXPECT_EQ(cell.relative,
              answer.error_bound / std::max(answer.force.norm(), relative_error_floor));
  }
  const double spacing = space.lattice.spacing();
  EXPECT_LE(errorDots(errors, spacing, LatticeCut{0, 0.005}).size(), errors.size());
  EXPECT_EQ(errorDots(errors, spacing, std::nullopt).size(), errors.size());
}

/// Regression: the scale followed the largest error, so an outlier of 1000 N gave all others one
/// colour.
TEST(LatticeDots, ColourErrorsWithoutRegardToOutliers) {
  EXPECT_EQ(errorPlace(0), 0);
  EXPECT_EQ(errorPlace(lowest_error), 0);
  EXPECT_NEAR(errorPlace(usual_force_error), 0.5, 1e-12);
  EXPECT_GT(errorPlace(noticeable_force_error), 0.6);
  EXPECT_EQ(errorPlace(2000), 1);
  const std::vector<CellError> errors = {{{0, 0, 0}, 0.03}},
                               more = {{{0, 0, 0}, 0.03}, {{0.1, 0, 0}, 2000}};
  EXPECT_EQ(errorDots(errors, 0.01, {})[0].colour, errorDots(more, 0.01, {})[0].colour);
}

}  // namespace
}  // namespace palpate
