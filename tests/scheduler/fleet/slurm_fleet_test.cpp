#include "scheduler/fleet/slurm_fleet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <future>
#include <sstream>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/system/process.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A build with two transitions to solve, and substitutes for Slurm's programs: squeue prints the
/// file `jobs`, scancel empties it, sbatch records the requested number. tests/system uses the real
/// programs.
struct SlurmFleetTest : testing::Test {
  test::TemporaryDirectory directory;
  test::BuildWorld world;
  zmq::context_t context;
  zmq::socket_t router = makeRouter(context);
  SlurmFleetOptions options;
  std::ostringstream log;
  const std::shared_ptr<spdlog::logger> log_before = spdlog::default_logger();
  const test::FirstInPath slurm_is{directory.path()};

  SlurmFleetTest() {
    options.asked.where = bindRouter(router, "tcp://127.0.0.1:*");
    options.asked.keys.insecure = true;
    options.endpoint = "tcp://head:7411";
    options.every_s = 0;
    options.give_up_s = 60;
    options.limits.transitions_each = 1;
    options.slurm.name = "palpate-0123";
    options.slurm.endpoint = options.endpoint;
    options.slurm.command = {"palpate-worker"};
    options.slurm.log = (directory / "job-%A_%a.log").string();
    const std::string jobs = (directory / "jobs").string();
    writeScript("squeue", "cat " + jobs);
    writeScript("scancel", ": > " + jobs);
    writeScript("sbatch", "sed -n 's/^#SBATCH --array=1-//p' >> " + (directory / "asked").string());
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "fleet", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  }
  ~SlurmFleetTest() override { spdlog::set_default_logger(log_before); }
  void writeScript(const char* name, const std::string& line) const {
    test::writeScript(directory / name, line);
  }

  /// From now on one job runs, started `time` ago ("1:00" is a minute).
  void jobRunsFor(const std::string& time) const {
    std::ofstream(directory / "jobs")
        << fmt::format("{:20}{:40}{:100}{:12}{:20}{:24}{:200}{:200}\n", "RUNNING", "27_1", "n1",
                       "0", time, "NONE", "palpate at " + options.endpoint, "None");
  }
  /// Workers requested since the last call.
  int takeAsked() const {
    int sum = 0;
    std::ifstream asked(directory / "asked");
    for (int workers = 0; asked >> workers;) sum += workers;
    asked.close();
    std::filesystem::remove(directory / "asked");
    return sum;
  }

  /// Runs a fleet. Calls each function of `moments`, a second apart, and lets the fleet query the
  /// scheduler after each call. Then completes the build, so the last function must let worker "a"
  /// join. Returns how many workers the fleet requested after each answer.
  std::vector<int> askedAfter(const std::vector<std::function<void()>>& moments) {
    std::vector<int> asked;
    auto fleet = std::async(std::launch::async, [&] { return SlurmFleet(options).run(); });
    Incoming question = nextQuestion();
    for (const auto& moment : moments) {
      moment();
      world.sleep(1s);
      int upon_answer = 0;
      // On a busy machine the fleet may have stopped waiting.
      do {
        answer(question);
        question = nextQuestion();
        upon_answer = takeAsked();
      } while (!hasHeard());
      asked.push_back(upon_answer);
    }
    world.finish({"a"});
    answer(question);
    while (fleet.wait_for(1ms) != std::future_status::ready)
      if (const auto again = receiveMessage(router, true)) answer(*again);
    EXPECT_EQ(fleet.get(), ExitCode::done);
    return asked;
  }
  Incoming nextQuestion() {
    for (const auto patience = std::chrono::steady_clock::now() + 60s;
         std::chrono::steady_clock::now() < patience;) {
      waitForMessages(router, 100ms);
      if (auto question = receiveMessage(router, true)) return *question;
    }
    throw failure("the fleet asks nothing any more");
  }
  void answer(const Incoming& question) {
    world.send(question.peer, question.message);
    for (const Outgoing& reply : std::exchange(world.inbox[question.peer], {}))
      EXPECT_NE(sendMessage(router, reply.peer, reply.message, reply.payload), Sent::full);
  }
  /// Returns whether the last answer reached the fleet, which logs changes.
  bool hasHeard() {
    spdlog::default_logger()->flush();
    const std::string news = log.str().substr(read_of_log);
    read_of_log += news.size();
    if (news.find("no answer within") != std::string::npos) heard = false;
    if (news.find("solves are ready") != std::string::npos) heard = true;
    return heard;
  }
  bool heard = true;
  std::size_t read_of_log = 0;
};

TEST_F(SlurmFleetTest, RequestsNoMoreIfRunningJobsDoNotConnect) {
  std::ofstream(directory / "job-27_1.log") << "starting\ntcp://head:7411: no route to host\n";
  const auto asked = askedAfter({
      [&] {
        world.sleep(58s);  // the scheduler has just started: workers may still connect
        jobRunsFor("2:00");
      },
      [&] { jobRunsFor("0:59"); },  // this one may still connect, too
      [&] { jobRunsFor("1:00"); },
      [&] { jobRunsFor("1-00:00:00"); },
      [&] { world.join("a", 8); },
  });
  EXPECT_THAT(asked, ElementsAre(1, 1, 0, 0, 1)) << log.str();
  const std::string told = "no worker has connected to the scheduler; no more jobs are submitted";
  EXPECT_THAT(
      log.str(),
      AllOf(HasSubstr(told), HasSubstr("tcp://head:7411 (--connect"), HasSubstr("palpate key"),
            HasSubstr("job-27_1.log ends with: tcp://head:7411: no route to host")));
  EXPECT_THAT(log.str().substr(log.str().find(told) + 1), Not(HasSubstr(told))) << "told once";
}

TEST_F(SlurmFleetTest, EndsWithSlurmsMessageIfAJobIsRefused) {
  std::ofstream(directory / "jobs").close();
  writeScript("sbatch", "echo 'sbatch: error: Invalid qos specification' >&2; exit 1");
  auto fleet = std::async(std::launch::async, [&] { return SlurmFleet(options).run(); });
  while (fleet.wait_for(1ms) != std::future_status::ready)
    if (const auto question = receiveMessage(router, true)) answer(*question);
  try {
    fleet.get();
    ADD_FAILURE() << "nothing is refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), ExitCode::usage);
    EXPECT_THAT(error.what(), HasSubstr("Invalid qos specification"));
  }
}

TEST_F(SlurmFleetTest, LeavesNoJobBehindIfItsStateDirectoryIsRenamed) {
  const std::filesystem::path state = world.directory / "state";
  world.build().directory().announce({options.asked.where, std::nullopt});
  options.asked.where = state.string();
  options.give_up_s = 1;
  jobRunsFor("2:00");
  auto fleet = std::async(std::launch::async, [&] { return SlurmFleet(options).run(); });
  const Incoming question = nextQuestion();
  std::filesystem::rename(state, world.directory / "renamed");
  answer(question);
  EXPECT_EQ(fleet.get(), ExitCode::failed);
  EXPECT_THAT(log.str(), HasSubstr("nor a state directory"));
  EXPECT_EQ(std::filesystem::file_size(directory / "jobs"), 0u) << "cancelled";
}

TEST_F(SlurmFleetTest, WarnsOfRemainingJobsIfInterruptedDuringARequest) {
  test::Process fleet(
      "palpate-scheduler",
      {"fleet", "slurm", options.asked.where, "--insecure", "--connect", options.endpoint},
      directory.path());
  answer(nextQuestion());
  nextQuestion();  // stays unanswered
  EXPECT_EQ(fleet.stop(SIGTERM), 130) << fleet.output();
  EXPECT_THAT(fleet.output(), HasSubstr("with --cancel it ends them"));
}

}  // namespace
}  // namespace palpate
