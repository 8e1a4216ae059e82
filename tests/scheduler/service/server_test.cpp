#include "scheduler/service/server.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "scheduler/builds/build.hpp"
#include "scheduler/service/status.hpp"
#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using wire::Message;

struct ServerTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  zmq::context_t context;
  Build build{problem, directory / "state", std::chrono::steady_clock::now(),
              test::BuildWorld::withoutChecks()};
  Server server{context, problem, "tcp://127.0.0.1:*"};
  std::map<void*, Inbox> inboxes;  ///< by socket

  zmq::socket_t connect() {
    zmq::socket_t socket = makeDealer(context);
    socket.set(zmq::sockopt::immediate, false);
    socket.connect(server.endpoint());
    return socket;
  }
  void send(zmq::socket_t& socket, const Message& message, const std::string& payload = "") {
    ASSERT_EQ(sendMessage(socket, "", message, payload), Sent::yes);
  }
  void sendRaw(zmq::socket_t& socket, const std::vector<std::string>& frames) {
    for (std::size_t n = 0; n < frames.size(); ++n)
      ASSERT_TRUE(socket.send(zmq::buffer(frames[n]), n + 1 < frames.size()
                                                          ? zmq::send_flags::sndmore
                                                          : zmq::send_flags::none));
  }
  /// Turns the server until a message of this kind arrives; others are dropped.
  Incoming expect(zmq::socket_t& socket, Message::BodyCase kind) {
    for (int turns = 0; turns < 500; ++turns) {
      server.turn(build.coordinator(), 10ms);
      while (auto incoming = inboxes[socket.handle()].next(socket, false))
        if (incoming->message.body_case() == kind) return *incoming;
    }
    ADD_FAILURE() << "no message of kind " << kind;
    return {};
  }
  void request(zmq::socket_t& socket, std::uint32_t credit) {
    Message message;
    message.mutable_request()->set_credit(credit);
    send(socket, message);
  }
  void join(zmq::socket_t& socket, const std::string& id) {
    send(socket, test::helloOf(id));
    expect(socket, Message::kWelcome);
  }
  void deliver(zmq::socket_t& socket, const wire::Job& job) {
    for (const wire::Target& target : job.targets()) {
      auto [result, payload] =
          test::solve(problem, job.space(), fromWire(target.point()), fromWire(job.start()));
      test::answer(job, target, result);
      Message message;
      *message.mutable_result() = result;
      send(socket, message, payload);
    }
  }
  std::int64_t counter(const std::string& name) {
    const wire::Status status = build.coordinator().status(std::chrono::steady_clock::now());
    const auto found = status.counters().find(name);
    return found == status.counters().end() ? 0 : found->second;
  }
};

TEST_F(ServerTest, CarriesAWorkerFromHelloToTheEnd) {
  zmq::socket_t worker = connect();
  join(worker, "w");
  Message ask;
  ask.mutable_problem_request();
  send(worker, ask);
  EXPECT_EQ(problemId(decodeProblem(expect(worker, Message::kProblemReply).payload)),
            problemId(problem));
  request(worker, 1);
  for (int jobs = 0; !build.coordinator().complete(); ++jobs) {
    ASSERT_LT(jobs, 1000);
    deliver(worker, expect(worker, Message::kJob).message.job());
    request(worker, 1);
    for (int turns = 0; turns < 3; ++turns) server.turn(build.coordinator(), 5ms);
  }
  build.coordinator().dismiss();
  EXPECT_TRUE(expect(worker, Message::kDrain).message.drain().finished());
}

/// A worker that is busy for minutes receives no messages: only a probe shows that it is gone.
TEST_F(ServerTest, NoticesABusyWorkersBrokenConnectionWithinSeconds) {
  zmq::socket_t worker = connect();
  join(worker, "w");
  request(worker, 1);
  expect(worker, Message::kJob);
  worker.close();
  const auto patience = std::chrono::steady_clock::now() + 30s;
  while (build.coordinator().workers() > 0 && std::chrono::steady_clock::now() < patience)
    server.turn(build.coordinator(), 50ms);
  EXPECT_EQ(build.coordinator().workers(), 0u);
  EXPECT_EQ(counter("lost_workers"), 1);
}

TEST_F(ServerTest, ListensOnLocalhostByNameAndByItsIPv6Address) {
  for (const auto& [wanted, is] :
       {std::pair("tcp://localhost:*", "tcp://127.0.0.1:"), {"tcp://[::1]:*", "tcp://[::1]:"}}) {
    const Server other(context, problem, wanted);
    EXPECT_TRUE(other.endpoint().starts_with(is)) << other.endpoint();
    EXPECT_TRUE(isOnThisMachineOnly(other.endpoint()));
  }
}

TEST_F(ServerTest, StillServesAfterGarbage) {
  zmq::socket_t hostile = connect();
  sendRaw(hostile, {""});
  sendRaw(hostile, {"\xff\xff\xff garbage"});
  sendRaw(hostile, {"", "", ""});
  sendRaw(hostile, {std::string(100000, '\x08'), std::string(70000, 'x')});
  Message result_without_hello;
  result_without_hello.mutable_result()->set_space(4000000000u);
  send(hostile, result_without_hello);
  expect(hostile, Message::kHeartbeatReply);
  EXPECT_EQ(counter("bad_messages"), 4);
  zmq::socket_t worker = connect();
  join(worker, "w");
  request(worker, 1);
  expect(worker, Message::kJob);
}

// ---- Keys ----

/// The same server and clients with their own keys.
struct KeyedServerTest : ServerTest {
  const KeyFolder keys{directory / "keys"};

  void SetUp() override {
    // The endpoint of the server without keys is not used here.
    keyed.emplace(keyed_context, problem, "tcp://127.0.0.1:*", keys);
  }
  void TearDown() override { keyed.reset(); }

  KeyFolder person(const char* name, const char* roles) const {
    const KeyFolder folder(directory / name);
    keys.allow({folder.ownOrNew().open(), rolesOf(roles), name});
    folder.trust(keys.own().open(), "*");
    return folder;
  }
  zmq::socket_t connectAs(const KeyFolder& folder) {
    zmq::socket_t socket = makeDealer(context);
    socket.set(zmq::sockopt::immediate, false);
    proveAsClient(socket, folder, keyed->endpoint());
    socket.connect(keyed->endpoint());
    return socket;
  }
  /// Sends a question and returns the answer.
  Message answerTo(zmq::socket_t& socket, const Message& question) {
    send(socket, question);
    for (int turns = 0; turns < 1000; ++turns) {
      keyed->turn(build.coordinator(), 10ms);
      if (auto incoming = inboxes[socket.handle()].next(socket, false)) return incoming->message;
    }
    ADD_FAILURE() << "no answer";
    return {};
  }

  zmq::context_t keyed_context;
  std::optional<Server> keyed;
};

Message statusRequest() {
  Message message;
  message.mutable_status_request();
  return message;
}

Message stopRequest() {
  Message message;
  message.mutable_stop_request();
  return message;
}

TEST_F(KeyedServerTest, EachRoleMaySendOnlyItsMessages) {
  // The list is read again within a second; all keys are created first to wait only once.
  const KeyFolder node = person("node", "worker"), viewer = person("viewer", "observer"),
                  boss = person("boss", "operator");
  keyed.reset();
  keyed.emplace(keyed_context, problem, "tcp://127.0.0.1:*", keys);
  zmq::socket_t worker = connectAs(node), observer = connectAs(viewer), operator_ = connectAs(boss);
  EXPECT_TRUE(answerTo(worker, test::helloOf("w")).has_welcome());
  EXPECT_TRUE(answerTo(observer, statusRequest()).has_status_reply());
  EXPECT_NE(answerTo(observer, stopRequest()).refused().reason().find("needs operator"),
            std::string::npos);
  EXPECT_NE(answerTo(observer, test::helloOf("o")).refused().reason().find("needs worker"),
            std::string::npos);
  EXPECT_EQ(build.coordinator().workers(), 1U) << "an observer is not a worker";
  EXPECT_FALSE(build.coordinator().stopping());
  EXPECT_TRUE(answerTo(operator_, statusRequest()).has_status_reply());
  EXPECT_TRUE(answerTo(operator_, stopRequest()).has_stop_reply());
}

TEST_F(KeyedServerTest, AWorkerWithAWithdrawnKeyIsSentAwayAndItsWorkReassigned) {
  const KeyFolder node = person("node", "worker");
  keyed.reset();
  keyed.emplace(keyed_context, problem, "tcp://127.0.0.1:*", keys);
  zmq::socket_t worker = connectAs(node);
  ASSERT_TRUE(answerTo(worker, test::helloOf("w")).has_welcome());
  Message message;
  message.mutable_request()->set_credit(1);
  ASSERT_TRUE(answerTo(worker, message).has_job());
  keys.withdraw("node");
  message.mutable_heartbeat();
  Message answer;
  for (int tries = 0; tries < 500 && !answer.has_refused(); ++tries) {
    answer = answerTo(worker, message);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_NE(answer.refused().reason().find("no longer allowed"), std::string::npos);
  EXPECT_EQ(build.coordinator().workers(), 0U);
  zmq::socket_t other = connectAs(keys);
  ASSERT_TRUE(answerTo(other, test::helloOf("other")).has_welcome());
  message.mutable_request()->set_credit(1);
  EXPECT_TRUE(answerTo(other, message).has_job());
}

TEST_F(ServerTest, AnswersPeopleBesideWorkers) {
  zmq::socket_t person = connect();
  send(person, statusRequest());
  const wire::Status status =
      statusFromJson(expect(person, Message::kStatusReply).message.status_reply().json(), "a");
  EXPECT_EQ(status.scene(), "cube");
  EXPECT_EQ(status.spaces_size(), 2);
  send(person, stopRequest());
  EXPECT_TRUE(expect(person, Message::kStopReply).message.stop_reply().stopping());
  EXPECT_TRUE(build.coordinator().stopping());
}

TEST_F(ServerTest, SaysThatAPortIsInUse) {
  test::expectError(ExitCode::failed, [&] { Server(context, problem, server.endpoint()); },
                    {server.endpoint(), "in use"});
}

}  // namespace
}  // namespace palpate
