#include "viewer/report/report_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/whole_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/report_json.hpp"
#include "viewer/report/report_text.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/run_accuracy.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A sealed sample dataset with probes, and reports of it.
class ReportCommand : public ::testing::Test {
 protected:
  ReportCommand() {
    options.report.datasets = {directory / "sample.h5"};
    options.report.seconds_per_timing = 0;
    options.report.looped_nodes = 0;
  }

  nlohmann::json json() {
    options.json = true;
    return nlohmann::json::parse(text());
  }

  std::string text() {
    sample.seal(options.report.datasets.front());
    std::ostringstream output;
    report(options, output);
    return output.str();
  }

  std::string page() {
    options.html = directory / "report.html";
    text();
    return readText(options.html, "page");
  }

  /// The arrays that the page of the last report draws.
  nlohmann::json drawings() const {
    const std::string html = readText(options.html, "page"), begin = "type=\"application/json\">";
    const std::size_t from = html.find(begin) + begin.size();
    return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from))
        .at("drawings");
  }

  /// Makes every lattice point but the first `kept` unreachable.
  void failBeyond(std::size_t kept) {
    for (SpaceTable& space : sample.spaces)
      for (std::size_t n = kept; n < space.points.size(); ++n) {
        space.points[n] = {};
        space.points[n].tag = Tag::failed;
        space.points[n].cause = Cause::unreachable;
      }
    sample.spaces.front().attempts.clear();
  }

  test::TemporaryDirectory directory;
  test::SampleDataset sample;
  ReportCommandOptions options;
};

/// The same, with probes and refined cells.
class RefinedReport : public ReportCommand {
 protected:
  RefinedReport() { sample.refine(); }

  /// The default report of this sample and what its page draws, created once per program.
  const nlohmann::json& usual() {
    static const nlohmann::json report = json();
    return report;
  }
  const nlohmann::json& usuallyDrawn() {
    static const nlohmann::json drawn = (page(), drawings());
    return drawn;
  }
};

TEST_F(RefinedReport, MeasuresEveryMethodWithTheProbes) {
  const nlohmann::json& report = usual();
  EXPECT_EQ(report["references"]["kind"], "probes");
  EXPECT_EQ(report["references"]["count"], 3);
  EXPECT_EQ(report["target"]["of_scene"], true);
  EXPECT_EQ(report["methods"].get<std::vector<std::string>>(), forceFieldMethods());
  const nlohmann::json& measured =
      report["lattices"][report["measured_lattice"].get<std::size_t>()];
  EXPECT_EQ(measured["factor"], 0);
  for (const std::string& method : forceFieldMethods()) {
    const nlohmann::json& measures = measured["methods"][method];
    EXPECT_EQ(measures["problem"], nullptr) << method;
    EXPECT_EQ(measures["whole_ball"]["count"], 3) << method;
    EXPECT_GT(measures["whole_ball"]["error"]["maximum"], 0) << method;
    EXPECT_GT(measures["nanoseconds_per_query"], 0) << method;
  }
}

TEST_F(RefinedReport, MeasuresTheWorkAroundClosedLoops) {
  options.report.methods = {"potential", "trilinear"};
  options.report.looped_nodes = 1;
  const nlohmann::json report = json();
  for (const nlohmann::json& lattice : report["lattices"])
    EXPECT_GT(lattice["methods"]["trilinear"]["loop_work"].get<double>(), 1e-6);
}

TEST_F(RefinedReport, ErrorsAreThoseOfTheForceFieldAtTheProbes) {
  const nlohmann::json& report = usual();
  double sum = 0;
  int count = 0;
  for (const SpaceTable& space : sample.spaces) {
    const auto field = makeForceField("trilinear", space);
    for (const Probe& probe : space.probes) {
      if (!isSolved(probe.record.tag)) continue;
      sum += (field->evaluate(probe.displacement).force - probe.record.equilibrium.force).norm();
      ++count;
    }
  }
  const nlohmann::json& measured =
      report["lattices"][report["measured_lattice"].get<std::size_t>()];
  EXPECT_NEAR(measured["methods"]["trilinear"]["whole_ball"]["error"]["mean"].get<double>(),
              sum / count, 1e-9 * sum);
}

TEST_F(RefinedReport, ShowsTheUnrefinedLatticeToo) {
  std::vector<int> factors;
  const nlohmann::json& report = usual();
  for (const nlohmann::json& lattice : report["lattices"]) factors.push_back(lattice["factor"]);
  EXPECT_THAT(factors, ::testing::ElementsAre(2, 1, 0));
}

TEST_F(RefinedReport, CountsFailuresByCauseAndJumps) {
  const nlohmann::json& report = usual();
  EXPECT_EQ(report["failures"]["wrong_inertia"]["points"], 1);
  EXPECT_EQ(report["failures"]["wrong_inertia"]["attempts"], 1);
  EXPECT_EQ(report["failures"]["factorization_failed"]["attempts"], 1);
  EXPECT_EQ(report["failures"]["step_budget"]["probes"], 1);
  EXPECT_EQ(report["nodes"][0]["points"]["terminating"], 1);
  EXPECT_GT(report["nodes"][1]["inconsistent_edges"], 0);
}

TEST_F(RefinedReport, PageNeedsNoOtherFiles) {
  sample.problem.scene.name = "</script><script>alert(1)</script>";
  const std::string html = page();
  for (const char* reference :
       {"https:", "<script>alert", "<link", "<img", "@import", "url(", "src=", "fetch("})
    EXPECT_THAT(html, Not(HasSubstr(reference)));
  EXPECT_EQ(drawings()["pictures"].size(), 2U);
  EXPECT_LT(html.size(), 1'000'000U);
}

TEST_F(RefinedReport, ShowsEqs13And14OverTheWay) {
  const nlohmann::json& report = usual();
  ASSERT_EQ(report["ways"].size(), 8U);
  std::size_t count = 0;
  double largest = 0;
  for (const nlohmann::json& shell : report["ways"]) {
    const nlohmann::json& measures = shell["methods"]["trilinear"];
    count += measures["count"].get<std::size_t>();
    if (measures["count"] > 0)
      largest = std::max(largest, measures["error"]["maximum"].get<double>());
  }
  const nlohmann::json& whole = report["lattices"][report["measured_lattice"].get<std::size_t>()]
                                      ["methods"]["trilinear"]["whole_ball"];
  EXPECT_EQ(count, whole["count"]);
  EXPECT_EQ(largest, whole["error"]["maximum"].get<double>());
}

TEST_F(RefinedReport, MarksHeldOutSolutionsOnCurvesThatLeadToThem) {
  for (const nlohmann::json& picture : usuallyDrawn()["pictures"])
    for (const nlohmann::json& way : picture["ways"]) {
      EXPECT_GT(way["held_out"][0].size(), 0U);
      EXPECT_EQ(way["sampled"].size(), forceFieldMethods().size());
    }
}

TEST_F(RefinedReport, DrawsActiveNodesOnTheOrganWithTheirBounds) {
  const nlohmann::json& drawn = usuallyDrawn();
  for (const nlohmann::json& node : drawn["nodes"]) {
    EXPECT_GE(node["largest_bound"].get<double>(), node["mean_bound"].get<double>());
    const std::int32_t number = node["node"];
    // The mark of a node lists all triangles that contain it, so it is visible if one of them is.
    std::vector<std::size_t> triangles;
    for (std::size_t n = 0; n < drawn["body"]["triangles"].size(); ++n)
      if (drawn["body"]["triangles"][n] == number) triangles.push_back(n / 3);
    EXPECT_EQ(node["at"]["triangles"].get<std::vector<std::size_t>>(), triangles);
  }
  options.report.methods = {"tricubic"};
  page();
  EXPECT_EQ(drawings()["nodes"][0]["mean_bound"], nullptr) << "tricubic gives none";
}

TEST_F(RefinedReport, TableFitsATerminal) {
  std::istringstream lines(text());
  for (std::string line; std::getline(lines, line);) {
    const bool names_a_file = line.find(directory.path().string()) != std::string::npos;
    EXPECT_TRUE(names_a_file || line.size() <= 100) << line;
  }
}

TEST_F(RefinedReport, ComparesOnlyTheRequestedMethods) {
  options.report.methods = {"trilinear", "potential", "trilinear"};
  EXPECT_EQ(json()["methods"].size(), 2U);
  options.report.methods = {"potential", "cubic"};
  expectBadInput([&] { text(); }, {"cubic", "potential", "trilinear"});
}

TEST_F(RefinedReport, MeasuresTheDefaultMethodOnNodesThatAreNotCompared) {
  options.report.compared_nodes = 1;
  const nlohmann::json report = json();
  EXPECT_EQ(report["compared_nodes"], 1);
  EXPECT_EQ(report["nodes"][0]["methods"].size(), forceFieldMethods().size());
  EXPECT_EQ(report["nodes"][1]["methods"].size(), 1U);
  EXPECT_EQ(report["nodes"][1]["methods"]["potential"]["count"], 2);
}

TEST_F(RefinedReport, UsesLeftOutPointsIfAllProbesFailed) {
  for (SpaceTable& space : sample.spaces)
    for (Probe& probe : space.probes) {
      probe.record = {};
      probe.record.tag = Tag::failed;
      probe.record.cause = Cause::step_budget;
    }
  const nlohmann::json report = json();
  EXPECT_EQ(report["references"]["kind"], "left-out lattice points");
  options.json = false;
  EXPECT_THAT(text(), HasSubstr("[accuracy] probes = 200"));
}

TEST_F(ReportCommand, WithoutProbesUsesLeftOutPointsAndSaysHowToGetProbes) {
  const nlohmann::json report = json();
  EXPECT_EQ(report["references"]["kind"], "left-out lattice points");
  EXPECT_EQ(report["references"]["count"], (33 - 7) * 2 - 2);  // one failed, one terminating
  const nlohmann::json& measured =
      report["lattices"][report["measured_lattice"].get<std::size_t>()];
  EXPECT_EQ(measured["factor"], 2);
  EXPECT_EQ(measured["configurations_per_node"].get<double>(), 6.5);  // one of 7 unknown
  options.json = false;
  EXPECT_THAT(text(), HasSubstr("[accuracy] probes = 200"));
}

TEST_F(ReportCommand, PageShowsForcesAlongTheAxesOnAllPointsOfTheDataset) {
  page();
  std::size_t solved = 0, marks = 0;
  for (const SpaceTable& space : sample.spaces)
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      const LatticePoint& point = space.lattice.point(n);
      const auto zeros = std::count(point.begin(), point.end(), 0);
      if (isSolved(space.points[n].tag)) solved += zeros == 3 ? 3 : zeros == 2 ? 1 : 0;
    }
  const nlohmann::json drawn = drawings();
  for (const nlohmann::json& picture : drawn["pictures"])
    for (const nlohmann::json& axis : picture["axes"]) marks += axis["solved"][0].size();
  EXPECT_EQ(marks, solved);
}

TEST_F(RefinedReport, ListsTheWorstActiveNodesFirst) {
  options.report.compared_nodes = 1;
  for (Probe& probe : sample.spaces[1].probes) probe.record.equilibrium.force *= 2;
  const std::string table = text();
  EXPECT_LT(table.find("\nedge-2 "), table.find("\ntip "));
  page();
  EXPECT_EQ(drawings()["pictures"][0]["node"], 1) << "of edge-2";
}

TEST_F(ReportCommand, SaysThatASingleConfigurationCannotBeMeasured) {
  failBeyond(1);
  const nlohmann::json report = json();
  EXPECT_EQ(report["references"]["kind"], "none");
  EXPECT_EQ(report["measured_lattice"], nullptr);
  EXPECT_EQ(report["failures"]["unreachable"]["points"], 64);
  options.json = false;
  EXPECT_THAT(text(), HasSubstr("unreachable"));
}

TEST_F(ReportCommand, WithoutAConfigurationSaysWhyThereIsNoMethod) {
  failBeyond(0);
  EXPECT_THAT(text(), HasSubstr("tip: "));
  const nlohmann::json report = json();
  for (const auto& [name, method] : report["lattices"][0]["methods"].items())
    EXPECT_TRUE(method["problem"].is_string()) << name;
}

/// The uncertainty over the surface, and how its probes confirm it.
TEST_F(ReportCommand, MeasuresAFingerWithItsProbes) {
  test::FingerBody(40).seal(directory / "sample.h5");
  options.html = directory / "report.html";
  options.json = true;
  std::ostringstream output;
  report(options, output);
  const nlohmann::json area = nlohmann::json::parse(output.str())["areas"].at(0);
  EXPECT_EQ(area["name"], "top");
  EXPECT_EQ(area["sites"], test::FingerBody().spaces.size());
  EXPECT_GT(area["samples"], 10);
  EXPECT_GT(area["relative_bound"]["median"], 0);
  EXPECT_EQ(area["depths"].size(), 5U);
  const nlohmann::json& probes = area["probes"];
  EXPECT_EQ(probes["places"], 40);
  EXPECT_EQ(probes["area"]["count"], 40);
  EXPECT_EQ(probes["not_answered"], 0);
  EXPECT_GT(probes["area"]["within_target"], probes["nearest_site"]["within_target"]);
  EXPECT_LT(probes["area"]["relative"]["median"],
            0.2 * probes["nearest_site"]["relative"]["median"].get<double>());
  EXPECT_GE(probes["area"]["bound_holds"], 0.9);
  const nlohmann::json page = drawings();
  EXPECT_EQ(page["areas_alone"], true);
  EXPECT_EQ(page["pictures"].size(), 0U) << "single sites, which nobody feels";
  const nlohmann::json& drawn = page["areas"].at(0);
  for (const char* which : {"median", "largest"})
    EXPECT_EQ(3 * drawn[which].size(), page["body"]["triangles"].size());
  ASSERT_EQ(drawn["probes"].size(), 40U);
  for (const nlohmann::json& probe : drawn["probes"])
    EXPECT_GT(probe["at"]["triangles"].size(), 0U) << "it is seen from somewhere";
  EXPECT_TRUE(std::ranges::any_of(
      drawn["ways"], [](const nlohmann::json& way) { return !way["held_out"][0].empty(); }));
}

TEST_F(ReportCommand, TakesSeveralDatasetsOfOneScene) {
  test::SampleDataset dense;
  dense.problem.scene.workspace.spacing = 0.005;
  dense.problem.scene.name = "dense";
  dense.lattice = uniformLattice(dense.problem.scene);
  for (std::size_t s = 0; s < dense.spaces.size(); ++s) {
    dense.spaces[s] = test::solvedSpace(dense.lattice, test::StiffeningEnergy());
    dense.spaces[s].patch = dense.problem.active[s];
    for (std::int32_t n = 0; n < dense.lattice.size(); ++n)
      dense.spaces[s].points[n].fields = dense.fields(s, n).id();
  }
  options.report.datasets.push_back(directory / "dense.h5");
  dense.seal(options.report.datasets.back());
  const nlohmann::json report = json();
  EXPECT_EQ(report["datasets"].size(), 2U);
  // The first dataset has 33 points, the second 257. The report thins the second by 3 and 4, but
  // not by 2, because every 2nd point gives the lattice of the first.
  EXPECT_EQ(report["lattices"].back()["configurations_per_node"].get<double>(), 257);
  const nlohmann::json& measured =
      report["lattices"][report["measured_lattice"].get<std::size_t>()];
  EXPECT_EQ(measured["label"], "sample.h5");
  EXPECT_GT(measured["methods"]["potential"]["whole_ball"]["count"], 0);
}

TEST_F(ReportCommand, RefusesFilesThatAreNotDatasets) {
  std::ostringstream output;
  expectBadInput([&] { report(options, output); }, {"sample.h5", "no such dataset"});
  std::ofstream(options.report.datasets.front()) << "something else";
  expectBadInput([&] { report(options, output); }, {"sample.h5", "not an HDF5 file"});
}

TEST_F(ReportCommand, RefusesARunThatIsNone) {
  std::ofstream(directory / "organ.toml") << "mesh = \"organ.msh\"\n";
  options.report.datasets.emplace_back(directory / "organ.toml");
  std::ostringstream output;
  expectBadInput([&] { report(options, output); }, {"organ.toml"});
  std::ofstream(directory / "organ.toml", std::ios::app)
      << "[material]\nlaw = \"mooney-rivlin\"\nc10 = 1300.0\nc01 = 1280.0\n"
      << "[fixed]\nbelow = { axis = \"z\", fraction = 0.05 }\n"
      << "[[active]]\nname = \"top\"\nnode = 1\n"
      << "[workspace]\nradius = 0.012\nspacing = 0.003\nmax_force = 8.0\n";
  expectBadInput([&] { text(); }, {"sample.h5", "not a recording"});
  options.report.methods = {"potential"};
  expectBadInput([&] { text(); }, {"--methods"});
}

TEST(RunReport, SaysHowManyTicksASecondFingerLeavesOut) {
  RunAccuracy run;
  run.held = 2288;
  EXPECT_EQ(toJson(run).at("held"), 2288);
  EXPECT_THAT(textOf(run), HasSubstr("2288"));
}

TEST_F(ReportCommand, NeverReplacesADatasetByItsPage) {
  options.html = directory / "." / "sample.h5";
  expectBadInput([&] { text(); },
                 {"--html", "sample.h5, which would be overwritten", "name another file"});
  EXPECT_NO_THROW(Dataset(options.report.datasets.front()));
}

TEST_F(ReportCommand, LeavesNoPartOfAPageThatCannotBeWritten) {
  options.html = directory / "missing" / "report.html";
  sample.seal(options.report.datasets.front());
  std::ostringstream output;
  test::expectError(ExitCode::failed, [&] { report(options, output); },
                    {"report.html", "cannot write into", "--html"});
  options.html = directory.path();
  test::expectError(ExitCode::failed, [&] { report(options, output); }, {"irectory"});
}

TEST(ReportWords, FormatNumbersBriefly) {
  EXPECT_EQ(formatNumber(0), "0");
  EXPECT_EQ(formatNumber(0.012345), "0.012");
  EXPECT_EQ(formatNumber(0.00012345), "1.2e-04");
  EXPECT_EQ(formatNumber(123.4, 3), "123");
  EXPECT_EQ(formatNumber(std::nan("")), "-");
  EXPECT_EQ(formatShare(0.99999), ">99.9 %");
  EXPECT_EQ(formatShare(1), "100.0 %");
  EXPECT_EQ(formatCount(925), "925");
  EXPECT_EQ(formatCount(12.34), "12.3");
  EXPECT_EQ(formatBytes(999), "999 B");
  EXPECT_EQ(formatBytes(12345), "12.3 kB");
  EXPECT_EQ(formatBytes(999.9e3), "1 MB");
}

}  // namespace
}  // namespace palpate
