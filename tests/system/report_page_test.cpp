#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/system/browser.hpp"

/// Pages of `palpate report` in a browser.
namespace palpate {
namespace {

using nlohmann::json;
using ::testing::IsEmpty;

/// Lists everything that is wrong in a page: script errors, invalid numbers, empty or clipped
/// drawings, references to other files, and text beyond the edge.
constexpr const char* faults_of_page = R"((() => {
  const faults = [...errors];
  if (/NaN|undefined|\[object|Infinity/.test(document.body.innerText)) faults.push("no number");
  if (performance.getEntriesByType("resource").length) faults.push("it loads something");
  if (document.documentElement.scrollWidth > innerWidth) faults.push("wider than the window");
  for (const drawing of document.querySelectorAll(".panel > svg")) {
    const name = drawing.closest("figure").id, { width, height } = drawing.viewBox.baseVal;
    if (/NaN|undefined|Infinity/.test(drawing.outerHTML)) faults.push(name + ": no number");
    if (!drawing.querySelector("path, circle")) faults.push(name + ": empty");
    for (const text of drawing.querySelectorAll("text")) {
      const box = drawing.getScreenCTM().inverse().multiply(text.getScreenCTM());
      const corner = new DOMPoint(text.getBBox().x, text.getBBox().y).matrixTransform(box);
      if (corner.x < -1 || corner.x > width || corner.y > height)
        faults.push(`${name}: "${text.textContent}" is cut off`);
    }
  }
  document.querySelectorAll("figure").forEach((figure, n) => {
    if (figure.id !== `figure-${n + 1}` || !figure.querySelector("figcaption").innerText.trim())
      faults.push(figure.id + ": no caption");
  });
  for (const drawing of saved) {
    const svg = new DOMParser().parseFromString(svgFile(drawing), "image/svg+xml");
    if (svg.querySelector("parsererror")) faults.push(drawing.name + ": no SVG");
    for (const [, , rows] of drawing.files)
      if (csvFile(rows()).split("\n").length < 3) faults.push(drawing.name + ": no numbers");
  }
  return faults;
})())";

struct ReportPageTest : testing::Test {
  test::TemporaryDirectory directory;

  void SetUp() override {
    if (test::runCommand("command -v chromium").exit_code != 0)
      GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  }
  /// Runs `palpate report` on files in the folder and opens the page in a browser.
  void open(test::Browser& browser, const std::string& files) const {
    const test::CommandResult made =
        test::runCommand("cd '" + directory.path().string() +
                         "' && " PALPATE_BIN_DIR "/palpate report -q -o page.html " + files);
    ASSERT_EQ(made.exit_code, 0) << made.output;
    browser.runFirst(
        "globalThis.errors = []; addEventListener('error', (e) => errors.push(e.message))");
    browser.go((directory / "page.html").string());
    ASSERT_TRUE(
        browser.becomesTrue("document.readyState === 'complete' && location.protocol === 'file:'"));
    EXPECT_THAT(browser.valueOf(faults_of_page), IsEmpty());
  }
  static std::vector<std::string> sectionsOf(test::Browser& browser) {
    return browser.valueOf("[...document.querySelectorAll('h2')].map((h2) => h2.id)");
  }
};

TEST_F(ReportPageTest, ShowsEveryFigureOfActiveNodes) {
  test::SampleDataset sample;
  sample.problem.scene.name = "</script><b id=\"other\">liver";
  sample.refine();
  sample.seal(directory / "sample.h5");
  test::Browser browser;
  open(browser, "sample.h5 --methods potential,trilinear");
  EXPECT_THAT(sectionsOf(browser),
              testing::ElementsAre("frontier", "ways", "loops", "bounds", "nodes", "organ", "maps",
                                   "curves", "failures", "sizes", "provenance"));
  // The page has figures of speed, errors along the way (two), loops, nodes and maps of the organ
  // (two), and for each of the two active nodes slices, axes and ways.
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('figure').length"), 7 + 2 * 3);
  EXPECT_EQ(browser.valueOf("document.getElementById('other')"), nullptr) << "names are escaped";
  EXPECT_THAT(browser.valueOf("saved[0].name").get<std::string>(),
              testing::MatchesRegex("[A-Za-z-]+-figure-1a"));
  // Discs of active nodes and colours of slices.
  EXPECT_GT(browser.valueOf("document.querySelectorAll('#figure-6 circle').length"), 1);
  EXPECT_GT(browser.valueOf("document.querySelectorAll('#figure-8 svg g path').length"), 10);

  browser.show({.width = 390, .height = 800, .scale = 2, .is_phone = true});
  EXPECT_THAT(browser.valueOf(faults_of_page), IsEmpty()) << "on a phone";
}

TEST_F(ReportPageTest, SavesADrawingAndItsNumbers) {
  test::SampleDataset sample;
  sample.refine();
  sample.seal(directory / "sample.h5");
  test::Browser browser;
  open(browser, "sample.h5 --methods potential");
  browser.send("Browser.setDownloadBehavior",
               {{"behavior", "allow"}, {"downloadPath", directory.path().string()}});
  for (const char* file : {"sample-figure-1a.svg", "sample-figure-1a.csv"}) {
    // By keyboard: a button that has the focus.
    browser.valueOf("document.querySelector('button[title=\"Save " + std::string(file) +
                    "\"]').focus()");
    for (const char* what : {"keyDown", "keyUp"})
      browser.send("Input.dispatchKeyEvent", {{"type", what},
                                              {"key", "Enter"},
                                              {"code", "Enter"},
                                              {"text", "\r"},
                                              {"windowsVirtualKeyCode", 13}});
    EXPECT_TRUE(test::eventually([&] { return std::filesystem::exists(directory / file); }))
        << file;
  }
  EXPECT_THAT(
      test::contentOf(directory / "sample-figure-1a.csv"),
      testing::StartsWith("series,configurations per active node,\"error of the force, N\""));
}

TEST_F(ReportPageTest, ShowsAFingersSurfaceWithItsProbes) {
  test::FingerBody(8).seal(directory / "finger.h5");
  test::Browser browser;
  open(browser, "finger.h5 --methods potential");
  EXPECT_THAT(sectionsOf(browser),
              testing::ElementsAre("areas", "curves", "failures", "sizes", "provenance"));
  // The page has two maps, and figures of the bounds over the displacement, the errors at probes,
  // the ways to sites and the ways to probes.
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('figure').length"), 6);
  EXPECT_GE(browser.valueOf("document.querySelectorAll('#figure-1 .panel circle').length"), 8);
}

TEST_F(ReportPageTest, ShowsTwoDatasetsSideBySide) {
  test::SampleDataset soft, stiff;
  stiff.problem.scene.regions[0].material.c10 *= 3;
  soft.seal(directory / "soft.h5");
  stiff.seal(directory / "stiff.h5");
  test::Browser browser;
  open(browser, "soft.h5 stiff.h5");
  EXPECT_THAT(sectionsOf(browser),
              testing::ElementsAre("properties", "forces", "differences", "provenance"));
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('figure').length"), 2 + 1 + 2);
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('tr.differs').length"), 1) << "material";
}

// Regression: the first figure showed the errors of a lattice of every 2nd point as if they were
// those of the dataset.
TEST_F(ReportPageTest, FirstFigureShowsNoErrorsOfAThinnedLattice) {
  test::SampleDataset sample;
  sample.seal(directory / "bare.h5");
  sample.refine();
  sample.seal(directory / "probed.h5");
  test::Browser browser;
  open(browser, "bare.h5 --methods potential");
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('.card').length"), 2);
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('.note').length"), 1) << "how to get probes";
  open(browser, "probed.h5 --methods potential");
  EXPECT_EQ(browser.valueOf("document.querySelectorAll('.card').length"), 6);
}

TEST_F(ReportPageTest, SaysThatASingleConfigurationCannotBeMeasured) {
  test::SampleDataset sample;
  for (SpaceTable& space : sample.spaces)
    for (std::size_t n = 1; n < space.points.size(); ++n) {
      space.points[n] = {};
      space.points[n].tag = Tag::failed;
      space.points[n].cause = Cause::unreachable;
    }
  sample.spaces.front().attempts.clear();
  sample.seal(directory / "one.h5");
  test::Browser browser;
  open(browser, "one.h5 --methods potential,tricubic");
  EXPECT_EQ(browser.valueOf("report.references.kind"), "none");
}

TEST_F(ReportPageTest, AxesHaveRoundNumbersAndColoursWholeDecades) {
  test::SampleDataset().seal(directory / "sample.h5");
  test::Browser browser;
  open(browser, "sample.h5 --methods potential");
  const auto valueOf = [&](const std::string& expression) {
    return browser.valueOf("JSON.stringify(" + expression + ")").get<std::string>();
  };
  EXPECT_EQ(valueOf("linearTicks(-61, 62)"), "[-50,0,50]");
  EXPECT_EQ(valueOf("logarithmicTicks(15, 250)"), "[20,50,100,200]");
  EXPECT_EQ(valueOf("logarithmicTicks(3.5, 6.5)"), "[4,5,6]");
  EXPECT_LE(browser.valueOf("logarithmicTicks(1e-14, 1e2).length"), 9);
  EXPECT_EQ(valueOf("[0, 0.02, 1e-5, 2e6].map(tickLabel)"), R"(["0","0.02","10⁻⁵","2·10⁶"])");
  EXPECT_EQ(valueOf("[NaN, 0, 1.2e-6, 34.4, 0.00123].map((v) => number(v))"),
            R"(["-","0","1.2e-06","34","0.0012"])");
  EXPECT_EQ(valueOf("[0.9999, 1, NaN].map(share)"), R"([">99.9 %","100.0 %","-"])");
  EXPECT_EQ(valueOf("(({ base, top, levelOf }) => [base, top, levelOf(0), levelOf(1e9)])("
                    "colourScale([3e-3, 0.2, NaN, 0, -1]))"),
            "[-3,0,0,24]");
  EXPECT_EQ(valueOf("[0, 24].map(colourOfLevel)"), R"json(["rgb(68,1,84)","rgb(253,231,37)"])json");
  EXPECT_EQ(valueOf("csvFile([['a, b', 'c \"d\"', 1.5, NaN]])"),
            R"("\"a, b\",\"c \"\"d\"\"\",1.5,\n")");
}

}  // namespace
}  // namespace palpate
