#include "worker/link/worker_session.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;
using Next = WorkerSession::Next;

/// A worker session; the test plays the scheduler and the solver.
struct WorkerSessionTest : testing::Test {
  const Problem problem = test::cubeProblem();
  const std::string problem_bytes = encodeProblem(problem);
  const std::string build = std::string(problemId(problem).bytes());
  WorkerSession::Time now = WorkerSession::Time() + 1h;
  std::vector<std::pair<Message, std::string>> said;
  Mailbox mailbox;
  WorkerSession session;

  explicit WorkerSessionTest(double leave_idle_s = 0)
      : session(mailbox,
                {.worker_id = "w",
                 .host = "here",
                 .kernel_family = "avx2",
                 .runs = {"baseline"},
                 .leave_idle_s = leave_idle_s},
                now) {}

  void hear(const Message& message, const std::string& payload = "") {
    session.receive({"", message, payload}, now);
    listen();
  }
  /// Advances in steps of a second until the session ends.
  Next pass(std::chrono::seconds time) {
    Next next = advance();
    for (; time > 0s && next == Next::go_on; time -= 1s) {
      now += 1s;
      answerHeartbeats();
      next = advance();
    }
    return next;
  }
  int count(Message::BodyCase kind) const {
    return static_cast<int>(std::ranges::count_if(
        said, [&](const auto& entry) { return entry.first.body_case() == kind; }));
  }
  void welcome(const std::string& epoch) {
    epoch_ = epoch;
    Message message;
    message.mutable_welcome()->set_epoch(epoch);
    message.mutable_welcome()->set_build(build);
    message.mutable_welcome()->set_heartbeat_ms(1000);
    hear(message);
  }
  void giveProblem() {
    Message message;
    message.mutable_problem_reply()->set_build(build);
    hear(message, problem_bytes);
  }
  void join() {
    pass(0s);
    welcome("first");
    giveProblem();
    said.clear();
  }
  static wire::Job originJob() {
    wire::Job job;
    job.set_id(1);
    job.set_hung_after_s(60);
    *job.mutable_start() = toWire(LatticePoint{});
    *job.add_targets()->mutable_point() = toWire(LatticePoint{});
    return job;
  }
  void giveJob(const wire::Job& job) {
    Message message;
    *message.mutable_job() = job;
    hear(message);
  }
  /// The solver takes a job and begins its first target.
  wire::Job beginJob() {
    const auto ready = mailbox.next(false);
    EXPECT_TRUE(ready && mailbox.begin(ready->job.id(), ready->job.targets(0).point()));
    return ready ? ready->job : wire::Job();
  }
  void finishJob(const wire::Job& job) {
    auto [result, payload] =
        test::solve(problem, job.space(), fromWire(job.targets(0).point()), fromWire(job.start()));
    mailbox.finish({result, payload, true});
    EXPECT_FALSE(mailbox.next(false));
  }
  void solveOrigin() {
    giveJob(originJob());
    finishJob(beginJob());
  }
  void acknowledge(bool unwanted = false) {
    Message message;
    wire::ResultAck& ack = *message.mutable_result_ack();
    *ack.mutable_target() = toWire(LatticePoint{});
    *ack.mutable_parent() = toWire(LatticePoint{});
    ack.set_unwanted(unwanted);
    hear(message);
  }
  void drainIt() {
    Message message;
    message.mutable_drain();
    hear(message);
  }

 private:
  Next advance() {
    const Next next = session.advance(now);
    listen();
    return next;
  }
  void listen() {
    for (Letter& letter : session.takeOutbox())
      for (Incoming& part : unbundled({"", std::move(letter.message), std::move(letter.payload)}))
        said.emplace_back(std::move(part.message), std::move(part.payload));
  }
  void answerHeartbeats() {
    Message message;
    message.mutable_heartbeat_reply()->set_epoch(epoch_);
    if (!epoch_.empty()) hear(message);
  }

  std::string epoch_;
};

TEST_F(WorkerSessionTest, SaysHelloUntilItIsWelcome) {
  pass(5s);
  EXPECT_EQ(count(Message::kHello), 6);
  welcome("first");
  pass(5s);
  EXPECT_EQ(count(Message::kHello), 6);
  EXPECT_EQ(count(Message::kProblemRequest), 1);
}

TEST_F(WorkerSessionTest, RequestsAMissingProblemAgain) {
  pass(0s);
  welcome("first");
  pass(12s);
  EXPECT_EQ(count(Message::kProblemRequest), 2);
}

TEST_F(WorkerSessionTest, RequestsJobsAgainWithoutAddingUp) {
  join();
  pass(25s);
  ASSERT_EQ(count(Message::kRequest), 2);
  for (const auto& [message, payload] : said)
    if (message.has_request()) {
      EXPECT_TRUE(message.request().afresh());
      EXPECT_EQ(message.request().credit(), 2u);
    }
}

TEST_F(WorkerSessionTest, RequestsTheStartOfAJobAgain) {
  join();
  wire::Job job = originJob();
  job.set_start_id(std::string(32, 's'));
  giveJob(job);
  EXPECT_EQ(count(Message::kFieldsRequest), 1);
  pass(12s);
  EXPECT_EQ(count(Message::kFieldsRequest), 2);
}

TEST_F(WorkerSessionTest, DeliversAResultUntilItIsAcknowledged) {
  join();
  solveOrigin();
  pass(25s);
  EXPECT_EQ(count(Message::kResult), 3);
  acknowledge();
  pass(25s);
  EXPECT_EQ(count(Message::kResult), 3);
  EXPECT_EQ(session.unacknowledged(), 0u);
}

TEST_F(WorkerSessionTest, DropsAResultThatIsNotNeeded) {
  join();
  solveOrigin();
  pass(1s);
  acknowledge(true);
  EXPECT_EQ(session.unacknowledged(), 0u);
}

TEST_F(WorkerSessionTest, LeavesWhenToldOnceAllIsAcknowledged) {
  join();
  solveOrigin();
  drainIt();
  EXPECT_EQ(pass(5s), Next::go_on);
  acknowledge();
  EXPECT_EQ(pass(0s), Next::end);
  EXPECT_EQ(count(Message::kGoodbye), 1);
  EXPECT_EQ(session.exitCode(), ExitCode::done);
}

TEST_F(WorkerSessionTest, WorksForTheNextSchedulerAfterOneSentItAway) {
  join();
  solveOrigin();
  drainIt();
  pass(1s);
  welcome("second");
  acknowledge();
  EXPECT_EQ(pass(3s), Next::go_on);
  EXPECT_EQ(count(Message::kRequest), 1);
}

TEST_F(WorkerSessionTest, LeavesInTimeAndAbandonsItsSolve) {
  join();
  giveJob(originJob());
  beginJob();
  session.interrupt(now);
  EXPECT_EQ(pass(9s), Next::go_on);
  EXPECT_EQ(pass(3s), Next::end);
  EXPECT_EQ(count(Message::kGoodbye), 1);
  EXPECT_EQ(session.exitCode(), ExitCode::interrupted);
}

TEST_F(WorkerSessionTest, EndsSilentlyWhenTheSolverHangs) {
  join();
  giveJob(originJob());
  beginJob();
  EXPECT_EQ(pass(59s), Next::go_on);
  EXPECT_EQ(pass(3s), Next::killed);
  EXPECT_EQ(count(Message::kGoodbye), 0);
}

TEST_F(WorkerSessionTest, RestartsWithTheKernelsOfTheBuildIfItHasThem) {
  pass(0s);
  ASSERT_EQ(said.at(0).first.hello().runs_size(), 1);
  Message message;
  message.mutable_use_kernels()->set_kernel_family("baseline");
  hear(message);
  EXPECT_EQ(pass(0s), Next::anew);
  EXPECT_EQ(session.wantedKernels(), "baseline");
  message.mutable_use_kernels()->set_kernel_family("avx512");
  test::expectError(ExitCode::failed, [&] { hear(message); }, {"avx512", "does not offer"});
}

/// A worker that leaves after a minute without work.
struct LeavingWorkerTest : WorkerSessionTest {
  LeavingWorkerTest() : WorkerSessionTest(60) {}
};

TEST_F(LeavingWorkerTest, LeavesAfterALongTimeWithoutWork) {
  join();
  EXPECT_EQ(pass(59s), Next::go_on);
  EXPECT_EQ(pass(3s), Next::end);
  EXPECT_EQ(count(Message::kGoodbye), 1);
  EXPECT_EQ(session.exitCode(), ExitCode::done);
}

TEST_F(LeavingWorkerTest, StaysWhileItHasWorkOrAResultToDeliver) {
  join();
  wire::Job job = originJob();
  job.set_hung_after_s(0);
  giveJob(job);
  EXPECT_EQ(pass(100s), Next::go_on) << "it waits";
  beginJob();
  EXPECT_EQ(pass(100s), Next::go_on) << "it is solved";
  finishJob(job);
  EXPECT_EQ(pass(100s), Next::go_on) << "it is not acknowledged";
  acknowledge();
  EXPECT_EQ(pass(59s), Next::go_on);
  EXPECT_EQ(pass(3s), Next::end);
}

TEST_F(WorkerSessionTest, DoesNotCountTheTimeOfASuspendedProcess) {
  join();
  giveJob(originJob());
  beginJob();
  pass(30s);
  now += 1h;
  EXPECT_EQ(pass(20s), Next::go_on) << "neither its solver hangs nor the scheduler is silent";
}

TEST_F(WorkerSessionTest, ReconnectsAndThenGivesUpWithoutAnAnswer) {
  EXPECT_EQ(pass(19s), Next::go_on);
  EXPECT_EQ(pass(3s), Next::connect);
  session.connected(now);
  const auto tryForEver = [&] {
    for (int times = 0; times < 100; ++times) {
      pass(30s);
      session.connected(now);
    }
  };
  test::expectError(ExitCode::failed, tryForEver, {"no message from"});
}

}  // namespace
}  // namespace palpate
