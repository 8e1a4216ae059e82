#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/table_worker.hpp"
#include "tests/system/process.hpp"

// How `serve` handles exceptions of its coordinator.

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

/// A real `palpate-scheduler serve`, and one worker that sends what a test tells it to.
struct ServeTest : testing::Test {
  ServeTest() {
    test::writeEndlessScene(directory.path(), 2, 1);
    serve.emplace("palpate-scheduler",
                  std::vector<std::string>{"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                           "--state", "state", "--insecure"},
                  directory.path());
    test::eventually([&] { return !test::endpointAnnouncedIn(directory / "state").empty(); });
    worker.set(zmq::sockopt::immediate, false);
    worker.connect(test::endpointAnnouncedIn(directory / "state"));
  }

  void send(const Message& message, const std::string& payload = "") {
    ASSERT_EQ(sendMessage(worker, "", message, payload), Sent::yes);
  }
  /// Waits for the next message of this kind; others are dropped.
  Incoming expect(Message::BodyCase kind) {
    Incoming found;
    const bool came = test::eventually([&] {
      while (auto incoming = inbox.next(worker, false))
        if (incoming->message.body_case() == kind) {
          found = std::move(*incoming);
          return true;
        }
      return !serve->running();
    });
    EXPECT_TRUE(came && serve->running()) << "no message of kind " << kind << serve->output();
    return found;
  }
  /// Sends a Hello and solves the first transition, the rest state.
  std::pair<wire::Result, std::string> solveFirst() {
    send(test::helloOf("worker"));
    expect(Message::kWelcome);
    Message ask;
    ask.mutable_problem_request();
    send(ask);
    const Problem problem = decodeProblem(expect(Message::kProblemReply).payload);
    ask.mutable_request()->set_credit(1);
    send(ask);
    const wire::Job job = expect(Message::kJob).message.job();
    const wire::Target& target = job.targets(0);
    auto solved = test::LinearBody(problem).solve(job.space(), target.point(), job.start());
    test::answer(job, target, solved.first);
    return solved;
  }
  void deliver(const wire::Result& result, const std::string& payload) {
    Message delivery;
    *delivery.mutable_result() = result;
    send(delivery, payload);
  }

  test::TemporaryDirectory directory;
  std::optional<test::Process> serve;
  zmq::context_t context;
  zmq::socket_t worker = makeDealer(context);
  Inbox inbox;
};

/// Regression: replacing the coordinator lost the request of `palpate stop`.
TEST_F(ServeTest, StopsOnRequestEvenIfALiarIsFoundMeanwhile) {
  auto [result, payload] = solveFirst();
  deliver(result, payload);
  expect(Message::kResultAck);
  Message stop;
  stop.mutable_stop_request();
  send(stop);
  expect(Message::kDrain);
  result.mutable_cost()->set_newton_iterations(77);
  deliver(result, payload);
  EXPECT_TRUE(test::eventually([&] { return !serve->running(); })) << serve->output();
  EXPECT_THAT(serve->output(), testing::HasSubstr(" differ; further workers solve"));
  EXPECT_THAT(serve->output(), testing::HasSubstr("stopped"));
  EXPECT_EQ(serve->stop(SIGKILL), 0);
}

}  // namespace
}  // namespace palpate
