#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/support/command.hpp"
#include "tests/support/http_get.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/system/small_build.hpp"

/// The HTTP pages of a scheduler, seen by a browser and Prometheus.
namespace palpate {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

bool isInstalled(const char* program) {
  return test::runCommand("command -v " + std::string(program) + " >/dev/null").exit_code == 0;
}

struct PagesTest : test::SmallBuild {
  std::unique_ptr<test::Process> scheduler, work;

  /// The body is large enough that the build takes a while.
  PagesTest() : SmallBuild(8) {}

  void begin(const std::vector<std::string>& options) {
    scheduler = serve("state", "out.h5", options);
    endpointIn("state");
  }
  void join() {
    work = start("palpate-worker", {"work", "--connect", endpointIn("state"), "-j", "1"});
  }
  /// The port that the log announces.
  int portOf(const std::string& what) const {
    const std::regex line(what + ": http://127\\.0\\.0\\.1:(\\d+)/");
    std::smatch found;
    const std::string log = scheduler->output();
    EXPECT_TRUE(std::regex_search(log, found, line)) << log;
    return found.empty() ? 0 : std::stoi(found[1]);
  }
  json statusNow() const {
    return json::parse(test::bodyOf(test::httpGet(portOf("dashboard"), "/status.json")));
  }
  /// Pauses the build when some points are solved. Returns the status, which no longer changes.
  json pausedOnTheWay() const {
    EXPECT_TRUE(journalGrows(*scheduler, "state", 100'000));
    told("pause state");
    EXPECT_TRUE(test::eventually([&] {
      const json status = statusNow();
      return status.at("paused") == true && status.at("workers").at(0).at("state") == "idle";
    }));
    return statusNow();
  }
  /// The page after its scripts ran for some seconds.
  std::string domOf(const std::string& address) const {
    return test::runCommand(
               "timeout -k 5 120 chromium --headless --no-sandbox --disable-gpu "
               "--user-data-dir='" +
               (directory / "profile").string() + "' --virtual-time-budget=4000 --dump-dom '" +
               address + "' 2>/dev/null")
        .output;
  }
};

TEST_F(PagesTest, MetricsAreValidForPrometheus) {
  if (!isInstalled("promtool")) GTEST_SKIP() << "NOT TESTED: promtool (Debian: prometheus)";
  begin({"--metrics", "0"});
  const std::string address = "127.0.0.1:" + std::to_string(portOf("metrics"));
  const test::CommandResult check = test::runCommand(
      "python3 -c 'import urllib.request; print(urllib.request.urlopen(\"http://" + address +
      "/metrics\").read().decode(), end=\"\")' | promtool check metrics");
  EXPECT_EQ(check.exit_code, 0) << check.output;
  EXPECT_EQ(check.output, "") << "and it has no remarks";
  EXPECT_THAT(test::httpGet(portOf("metrics"), "/"), testing::StartsWith("HTTP/1.1 404"))
      << "metrics alone";
}

TEST_F(PagesTest, PrometheusScrapesThem) {
  if (!test::longTestsAreWanted()) GTEST_SKIP() << "set PALPATE_LONG_TESTS";
  if (!isInstalled("prometheus")) GTEST_SKIP() << "NOT TESTED: prometheus is not installed";
  begin({"--metrics", "0", "--dashboard"});
  join();
  pausedOnTheWay();
  std::ofstream(directory / "prometheus.yml")
      << "global: {scrape_interval: 1s}\nscrape_configs:\n  - job_name: palpate\n"
      << "    static_configs: [{targets: ['127.0.0.1:" << portOf("metrics") << "']}]\n";
  const int port = 20000 + getpid() % 10000;
  test::Process prometheus("/usr/bin/prometheus",
                           {"--config.file=prometheus.yml", "--storage.tsdb.path=tsdb",
                            "--web.listen-address=127.0.0.1:" + std::to_string(port)},
                           directory.path());
  const auto valueOf = [&](const std::string& query) {
    const json answer = json::parse(
        test::bodyOf(test::httpGet(port, "/api/v1/query?query=" + query)), nullptr, false);
    if (!answer.is_object() || answer.at("data").at("result").empty()) return -1.0;
    return std::stod(answer.at("data").at("result").at(0).at("value").at(1).get<std::string>());
  };
  EXPECT_TRUE(test::eventually([&] { return valueOf("sum(palpate_points)") == 514; }))
      << prometheus.output();
  EXPECT_EQ(valueOf("up"), 1);
  EXPECT_TRUE(test::eventually([&] { return valueOf("palpate_results_total") > 0; }));
  EXPECT_TRUE(test::eventually([&] { return valueOf("sum(palpate_workers)") == 1; }));
}

TEST_F(PagesTest, TheDashboardShowsTheNumbersOfTheStatus) {
  if (!isInstalled("chromium")) GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  begin({"--dashboard"});
  join();
  const json status = pausedOnTheWay();
  const std::string dom = domOf("http://localhost:" + std::to_string(portOf("dashboard")) + "/");
  int known = 0;
  for (const json& space : status.at("spaces")) {
    std::string row = "data-space=\"" + space.at("name").get<std::string>() + "\".*";
    for (const char* field : {"points", "expandable", "terminating", "failed", "unknown"})
      row += ">" + std::to_string(space.at(field).get<int>()) + "</td>[^/]*";
    EXPECT_TRUE(std::regex_search(dom, std::regex(row))) << row << "\n" << dom;
    known += space.at("points").get<int>() - space.at("unknown").get<int>();
  }
  EXPECT_THAT(dom, AllOf(HasSubstr(">cube</h1>"), HasSubstr("id=\"state\">paused</span>"),
                         HasSubstr(">" + std::to_string(known) + " of 514<"),
                         HasSubstr("id=\"frontier\">" +
                                   std::to_string(status.at("ready").get<int>()) + "<"),
                         HasSubstr("id=\"workers\">1<"), HasSubstr("worker joined, "),
                         HasSubstr("paused"), Not(HasSubstr("class=\"silent\""))));
}

TEST_F(PagesTest, TheDashboardExplainsAPoint) {
  if (!isInstalled("chromium")) GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  begin({"--dashboard"});
  join();
  pausedOnTheWay();
  const std::string dom = domOf("http://127.0.0.1:" + std::to_string(portOf("dashboard")) +
                                "/#cause=step_budget&space=tip&point=0,0,0");
  EXPECT_THAT(dom, HasSubstr("tip: point (0, 0, 0), displacement (0, 0, 0) m: expandable"));
}

/// A machine may report any host name.
TEST_F(PagesTest, NamesOfMachinesCannotBecomeScripts) {
  if (!isInstalled("chromium")) GTEST_SKIP() << "NOT TESTED: chromium is not installed";
  if (geteuid() != 0) GTEST_SKIP() << "NOT TESTED: only root can change the host name";
  begin({"--dashboard"});
  const std::string name = "<img src=x onerror=document.title=7>";
  work = std::make_unique<test::Process>(
      "/usr/bin/unshare",
      std::vector<std::string>{
          "--uts", "python3", "-c",
          "import os, socket, sys; socket.sethostname(sys.argv[1]); os.execv(sys.argv[2], "
          "sys.argv[2:])",
          name, PALPATE_BIN_DIR "/palpate-worker", "work", "--connect", endpointIn("state"), "-j",
          "1"},
      directory.path());
  ASSERT_EQ(pausedOnTheWay().at("workers").at(0).at("host"), name);
  const std::string dom = domOf("http://localhost:" + std::to_string(portOf("dashboard")) + "/");
  EXPECT_THAT(dom, AllOf(HasSubstr("&lt;img src=x onerror"), Not(HasSubstr("<img")),
                         HasSubstr("<title>cube")));
}

TEST_F(PagesTest, InvalidRequestsAreExplained) {
  begin({"--dashboard"});
  const int port = portOf("dashboard");
  EXPECT_THAT(test::httpGet(port, "/explain.json?active=tip&i=9&j=0&k=0"),
              AllOf(HasSubstr("400"), HasSubstr("is not in the lattice")));
  EXPECT_THAT(test::httpGet(port, "/explain.json?active=nobody&i=0&j=0&k=0"), HasSubstr("corner"));
  EXPECT_THAT(test::httpGet(port, "/explain.json?active=tip&i=x&j=0&k=0"),
              HasSubstr("is not a number"));
  EXPECT_THAT(test::httpGet(port, "/events.json?event=started"), HasSubstr("\"scene\":\"cube\""));
  EXPECT_THAT(test::httpGet(port, "/", "Host: elsewhere.example\r\n"), HasSubstr("403"));
  EXPECT_THAT(test::httpGet(port, "/"), HasSubstr("default-src 'none'; script-src 'nonce-"));

  const std::string taken = std::to_string(port);
  const std::string again = "serve cube.toml --listen tcp://127.0.0.1:* --state other -o o.h5 ";
  EXPECT_THAT(told(again + "--dashboard=" + taken, 1), HasSubstr("Address already in use"));
  EXPECT_FALSE(std::filesystem::exists(directory / "other")) << "nothing was begun";
  told(again + "--metrics nowhere", 2);
  told(again + "--dashboard=nowhere", 2);
  EXPECT_EQ(scheduler->stop(SIGTERM), 130);
}

}  // namespace
}  // namespace palpate
