#include "scheduler/web/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "tests/support/file_bytes.hpp"

namespace palpate {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A status with a value in every part.
wire::Status fullStatus() {
  wire::Status status;
  status.set_scene("liver");
  status.set_state("running");
  wire::SpaceStatus& space = *status.add_spaces();
  space.set_name("tip");
  space.set_points(515);
  space.set_unknown(300);
  space.set_expandable(215);
  space.set_stage("lattice");
  for (const char* state : {"busy", "busy", "idle"}) {
    wire::WorkerStatus& worker = *status.add_workers();
    worker.set_host("node\"1\"");
    worker.set_state(state);
  }
  (*status.mutable_failed_attempts())["step_budget"] = 2;
  (*status.mutable_failed_points())["unreachable"] = 1;
  (*status.mutable_counters())["lost_workers"] = 4;
  status.set_configurations_per_second(40.5);
  status.set_eta_seconds(7.6);
  status.set_eta_low_seconds(5);
  status.set_eta_high_seconds(11);
  status.set_journal_bytes(12345678901);
  return status;
}

std::set<std::string> namesIn(const std::string& text, const std::regex& what) {
  std::set<std::string> names;
  for (std::sregex_iterator at(text.begin(), text.end(), what), end; at != end; ++at)
    names.insert((*at)[1]);
  return names;
}

TEST(Metrics, ExportsExactlyTheDocumentedNames) {
  const std::string page = test::bytesIn(PALPATE_SOURCE_DIR "/docs/metrics.md");
  const auto documented = namesIn(page, std::regex("\\| `(palpate_[a-z_]+)"));
  EXPECT_GT(documented.size(), 30u);
  EXPECT_EQ(namesIn(metricsOf(fullStatus(), 0), std::regex("# TYPE ([^ ]+) ")), documented);
}

TEST(Metrics, HasALineForEverySeries) {
  const std::string text = metricsOf(fullStatus(), 0.5);
  for (const char* line :
       {"\npalpate_points{space=\"tip\",tag=\"unknown\"} 300\n",
        "\npalpate_workers{host=\"node\\\"1\\\"\",state=\"busy\"} 2\n",
        "\npalpate_failed_attempts{cause=\"step_budget\"} 2\n", "\npalpate_eta_low_seconds 5\n",
        "\npalpate_state{state=\"running\"} 1\n", "\npalpate_state{state=\"complete\"} 0\n",
        "\npalpate_lost_workers_total 4\n", "\npalpate_wrong_results_total 0\n",
        "\npalpate_journal_bytes 12345678901\n", "\npalpate_status_age_seconds 0.5\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_TRUE(text.ends_with("\n"));
}

TEST(Metrics, OmitsUnknownValues) { EXPECT_THAT(metricsOf({}, 0), Not(HasSubstr("palpate_eta"))); }

TEST(Metrics, EscapesLabels) { EXPECT_EQ(escapedLabel("a\\b\"c\nd"), "a\\\\b\\\"c\\nd"); }

TEST(Metrics, ManySpacesAreSummedUpAsOne) {
  wire::Status status;
  for (int n = 0; n < 1000; ++n) {
    wire::SpaceStatus& space = *status.add_spaces();
    space.set_name("skin-" + std::to_string(n));
    space.set_stage(n < 10 ? "complete" : "lattice");
    space.set_unknown(3);
  }
  const std::string text = metricsOf(status, 0);
  EXPECT_THAT(text, HasSubstr("palpate_points{space=\"all\",tag=\"unknown\"} 3000\n"));
  EXPECT_THAT(text, HasSubstr("palpate_spaces{stage=\"complete\"} 10\n"));
  EXPECT_THAT(text, Not(HasSubstr("skin")));
}

}  // namespace
}  // namespace palpate
