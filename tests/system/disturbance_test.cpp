#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "tests/support/command.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/system/own_network.hpp"
#include "tests/system/small_build.hpp"

/// Schedulers, workers and their supervisors are killed and stopped at random moments, and
/// restarted when they have died.
namespace palpate {
namespace {

using test::Process;
using testing::HasSubstr;
using testing::Not;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

double secondsOf(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// One build with its scheduler, its supervisor and two workers.
class DisturbedBuild {
 public:
  DisturbedBuild(const std::filesystem::path& directory, int number)
      : directory_(directory),
        state_("served-" + std::to_string(number)),
        last_disturbed_(Clock::now()) {}
  ~DisturbedBuild() {
    workers_.reset();
    for (const pid_t worker : known_workers_)
      if (isOurs(worker)) kill(worker, SIGKILL);
  }
  DisturbedBuild(const DisturbedBuild&) = delete;
  DisturbedBuild& operator=(const DisturbedBuild&) = delete;

  std::filesystem::path dataset() const { return directory_ / (state_ + ".h5"); }
  const std::string& state() const { return state_; }
  bool finished() const { return finished_; }
  Clock::time_point lastDisturbed() const { return last_disturbed_; }
  int timesRetried() const { return retried_; }
  /// The list of disturbances, for people.
  const std::string& story() const { return story_; }

  /// Restarts processes that the test ended, and resumes stopped ones when their time is over. A
  /// process that ended for another reason before completion is a failure.
  void mend() {
    std::erase_if(stopped_, [&](const auto& entry) {
      if (Clock::now() < entry.second) return false;
      kill(entry.first, SIGCONT);
      return true;
    });
    if (scheduler_ && !scheduler_->running()) schedulerEnded(scheduler_->wait());
    if (finished_) return;
    if (!scheduler_) {
      scheduler_killed_ = false;
      startScheduler();
    }
    if (endpoint_.empty()) {
      endpoint_ = test::endpointAnnouncedIn(directory_ / state_);
      if (endpoint_.empty()) return;
    }
    if (workers_ && !workers_->running()) supervisorEnded(workers_->wait());
    if (workers_ || finished_) return;
    workers_killed_ = false;
    workers_ = std::make_unique<Process>(
        "palpate-worker",
        std::vector<std::string>{"work", "--connect", endpoint_, "-j", "2", "--drain", "1"},
        directory_);
  }

  /// Kills or stops one of its processes, or kills all. False if that process does not run at the
  /// moment.
  bool disturb(std::mt19937& dice) {
    const auto atMost = [&](int largest) {
      return std::uniform_int_distribution(0, largest)(dice);
    };
    if (!scheduler_ || !workers_) return false;
    const std::vector<pid_t> workers = workers_->children();
    known_workers_.insert(workers.begin(), workers.end());
    if (workers.empty()) return false;
    const pid_t worker = workers[static_cast<std::size_t>(atMost(1000)) % workers.size()];
    const std::array victims = {scheduler_->pid(), worker, workers_->pid()};
    const auto whose = static_cast<std::size_t>(atMost(2));
    const pid_t victim = victims[whose];
    static constexpr std::array names = {"scheduler", "worker", "supervisor"};
    const int what = atMost(9);
    last_disturbed_ = Clock::now();
    if (what < 4) {
      // Mostly short stops; sometimes longer than the gap that schedulers and workers notice
      // themselves.
      const milliseconds time(atMost(9) == 0 ? 3000 + atMost(3000) : 100 + atMost(900));
      stopped_[victim] = last_disturbed_ + time;
      kill(victim, SIGSTOP);
      tell(std::string("stop ") + names[whose] + " for " + std::to_string(time.count()) + " ms");
      return true;
    }
    const bool all = what == 9;
    scheduler_killed_ = scheduler_killed_ || all || whose == 0;
    workers_killed_ = workers_killed_ || all || whose == 2;
    if (all) {
      for (const pid_t each : workers) kill(each, SIGKILL);
      for (const pid_t each : victims) kill(each, SIGKILL);
    } else {
      kill(victim, SIGKILL);
    }
    tell(std::string("kill ") + (all ? "all" : names[whose]));
    return true;
  }

 private:
  void startScheduler() {
    // Listen on the same port after a restart, because the workers know only this port.
    const std::string listen = endpoint_.empty() ? "tcp://127.0.0.1:*" : endpoint_;
    scheduler_ =
        std::make_unique<Process>("palpate-scheduler",
                                  std::vector<std::string>{"serve", "cube.toml", "--listen", listen,
                                                           "--state", state_, "-o", state_ + ".h5"},
                                  directory_);
  }
  void schedulerEnded(int code) {
    const std::string output = scheduler_->output();
    scheduler_.reset();
    finished_ = code == 0 || code == 3;
    if (finished_ || (code == 128 + SIGKILL && scheduler_killed_)) return;
    // By chance, five workers may have been killed during one transition, which is then set aside.
    if (code == 1 && output.find("set aside") != std::string::npos) {
      ++retried_;
      tell("retry");
      Process retry("palpate-scheduler", {"retry", state_}, directory_);
      EXPECT_EQ(retry.wait(), 0) << retry.output();
      return;
    }
    ADD_FAILURE() << "the scheduler ended with " << code << "\n" << output << story_;
    finished_ = true;
  }
  void supervisorEnded(int code) {
    const std::string output = workers_->output();
    workers_.reset();
    // The code is 0 if the scheduler had just completed. The supervisor also gives up when too many
    // workers were killed.
    if ((code == 128 + SIGKILL && workers_killed_) || code == 0 ||
        output.find("right after its start") != std::string::npos)
      return;
    ADD_FAILURE() << "the supervisor ended with " << code << "\n" << output << story_;
  }
  bool isOurs(pid_t worker) const {
    const std::string command = test::contentOf("/proc/" + std::to_string(worker) + "/cmdline");
    return command.find("palpate-worker") != std::string::npos &&
           command.find(endpoint_) != std::string::npos;
  }
  void tell(const std::string& what) {
    story_ += std::to_string(secondsOf(Clock::now() - began_)) + " s: " + what + "\n";
  }

  std::filesystem::path directory_;
  std::string state_, endpoint_, story_;
  std::unique_ptr<Process> scheduler_, workers_;
  bool scheduler_killed_ = false, workers_killed_ = false, finished_ = false;
  int retried_ = 0;
  std::map<pid_t, Clock::time_point> stopped_;  ///< until when
  std::set<pid_t> known_workers_;
  Clock::time_point began_ = Clock::now(), last_disturbed_;
};

struct DisturbanceTest : test::SmallBuild {
  test::OwnNetwork network;

  /// Disturbs `at_once` builds at a time, at random, until `wanted` disturbances are done.
  void disturbAndFinish(int wanted, int at_once) {
    const unsigned seed = test::testSeed();
    SCOPED_TRACE("PALPATE_TEST_SEED=" + std::to_string(seed));
    std::mt19937 dice(seed);
    expected_ = undisturbed();
    std::vector<std::unique_ptr<DisturbedBuild>> builds;
    int disturbances = 0;
    auto done_at = Clock::now();
    const auto patience = std::chrono::seconds(100);
    while (!HasFailure() && (disturbances < wanted || !builds.empty())) {
      std::erase_if(builds, [&](const auto& build) {
        build->mend();
        if (build->finished()) judge(*build);
        return build->finished();
      });
      while (disturbances < wanted && builds.size() < static_cast<std::size_t>(at_once))
        builds.push_back(std::make_unique<DisturbedBuild>(directory.path(), ++begun_));
      std::this_thread::sleep_for(
          milliseconds(std::uniform_int_distribution(1, 500 / at_once)(dice)));
      if (disturbances < wanted) {
        DisturbedBuild& chosen =
            *builds[std::uniform_int_distribution<std::size_t>(0, builds.size() - 1)(dice)];
        disturbances += chosen.disturb(dice);
        done_at = Clock::now();
      } else if (Clock::now() - done_at > patience) {
        ADD_FAILURE() << "the build does not end after its last disturbance\n"
                      << builds.front()->story();
      }
    }
    std::cout << "seed " << seed << ": " << disturbances << " disturbances, " << finished_
              << " builds, the last disturbance of one at most " << longest_end_
              << " s before its end, " << retried_ << " retried" << std::endl;
  }

 private:
  void judge(const DisturbedBuild& build) {
    ++finished_;
    retried_ += build.timesRetried();
    longest_end_ = std::max(longest_end_, secondsOf(Clock::now() - build.lastDisturbed()));
    EXPECT_TRUE(test::contentOf(build.dataset()) == expected_) << "another dataset\n"
                                                               << build.story();
    const test::CommandResult status =
        test::runCommand(PALPATE_BIN_DIR "/palpate-scheduler status --json '" +
                         (directory / build.state()).string() + "'");
    EXPECT_THAT(status.output,
                testing::AllOf(HasSubstr("\"state\":\"complete\""),
                               Not(HasSubstr("divergent_results")), Not(HasSubstr("bad_messages"))))
        << build.story();
    std::filesystem::remove_all(directory / build.state());
    std::filesystem::remove(build.dataset());
  }

  std::string expected_;
  int begun_ = 0, finished_ = 0, retried_ = 0;
  double longest_end_ = 0;  ///< s
};

TEST_F(DisturbanceTest, TwentyKillsAndStopsLeaveNoTrace) { disturbAndFinish(20, 2); }

TEST_F(DisturbanceTest, AThousandKillsAndStopsLeaveNoTrace) {
  if (!test::longTestsAreWanted())
    GTEST_SKIP() << "1000 kills and stops take minutes and were NOT tested; "
                    "set PALPATE_LONG_TESTS=1 (deploy/test --nightly does)";
  disturbAndFinish(1000, 4);
}

// ---- A worker on another machine ----

struct RemoteWorkerTest : test::SmallBuild {
  RemoteWorkerTest() : SmallBuild(6) {}

  std::unique_ptr<Process> work(const std::string& endpoint) {
    return start("palpate-worker", {"work", "--alone", "--connect", endpoint});
  }

  test::OwnNetwork network;
};

TEST_F(RemoteWorkerTest, AKilledWorkersTargetsAreReassignedAtOnce) {
  const bool two_networks = network.joinAnother();
  const std::string address = two_networks ? "10.77.0.1" : "127.0.0.1";
  auto scheduler = serve("served", "served.h5", {}, "tcp://" + address + ":*");
  const std::string endpoint = endpointIn("served");
  if (two_networks) network.goThere();
  auto far = work(endpoint);
  if (two_networks) network.goHere();
  const std::string its_name = "worker " + std::to_string(far->pid()) + " on ";
  ASSERT_TRUE(test::says(*scheduler, its_name));
  ASSERT_TRUE(journalGrows(*scheduler, "served", 20000));
  const auto killed_at = Clock::now();
  far->stop(SIGKILL);
  const auto lineThatTells = [&] {
    const std::string output = scheduler->output();
    const std::size_t to = output.find("other workers get its");
    return to == std::string::npos ? "" : output.substr(output.rfind('\n', to) + 1);
  };
  ASSERT_TRUE(test::eventually([&] { return !lineThatTells().empty(); })) << scheduler->output();
  const std::string seconds = std::to_string(secondsOf(Clock::now() - killed_at));
  RecordProperty("seconds_until_handed_out_again", seconds);
  std::cout << (two_networks ? "two networks" : "one network") << ": handed out again after "
            << seconds << " s" << std::endl;
  EXPECT_THAT(lineThatTells(), HasSubstr(its_name));
  EXPECT_THAT(lineThatTells(), HasSubstr("unreachable"));
  // A worker beside the killed one could complete the build before the loss is noticed.
  auto near = work(endpoint);
  expectFinished(*scheduler);
  EXPECT_THAT(scheduler->output(), Not(HasSubstr("silent")));
  EXPECT_EQ(near->wait(), 0) << near->output();
  EXPECT_TRUE(test::contentOf(directory / "served.h5") == undisturbed());
}

}  // namespace
}  // namespace palpate
