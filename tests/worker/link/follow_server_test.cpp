#include "worker/link/follow_server.hpp"

#include <gtest/gtest.h>

#include "common/problem/finger.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr double served_radius = 0.06;

/// A follower and clients of it, in one thread.
class FollowServerTest : public ::testing::Test {
 protected:
  FollowServerTest() {
    problem_ = test::fingeredBlob(served_radius);
    hand_ = {problem_.active[0].finger->center, {-0.008, 0.012, 0.006}};
  }

  zmq::socket_t client() {
    zmq::socket_t socket = makeDealer(context_);
    EXPECT_EQ(connectDealer(socket, server_.endpoint()), "");
    return socket;
  }
  /// What the server answers; an empty message if it does not.
  wire::Message ask(zmq::socket_t& socket, const wire::Message& question,
                    std::string_view payload = {}) {
    Sent sent = Sent::full;  // until the connection stands
    for (int n = 0; n < 200 && sent != Sent::yes; ++n) {
      sent = sendMessage(socket, "", question, payload);
      server_.turn(5ms);
    }
    EXPECT_EQ(sent, Sent::yes);
    for (int n = 0; n < 200; ++n) {
      server_.turn(5ms);
      if (auto reply = receiveMessage(socket, false)) return reply->message;
    }
    return {};
  }
  wire::Message begin(zmq::socket_t& socket, const std::string& problem,
                      std::uint32_t protocol = protocol_version) {
    wire::Message question;
    question.mutable_follow_request()->set_protocol(protocol);
    question.mutable_follow_request()->set_finger_radius(served_radius);
    question.mutable_follow_request()->set_payload_bytes(
        static_cast<std::uint32_t>(problem.size()));
    return ask(socket, question, problem);
  }
  wire::Message follow(zmq::socket_t& socket, const HandMotion& hand) {
    wire::Message question;
    toWire(hand, *question.mutable_hand_motion());
    return ask(socket, question);
  }

  test::TemporaryDirectory directory_;
  zmq::context_t context_;
  Problem problem_;
  HandMotion hand_;
  FollowServer server_{"ipc://" + (directory_ / "follower").string(), chooseKernels(), {}};
};

TEST_F(FollowServerTest, AnswersAHandWithTheEquilibriumNearIt) {
  zmq::socket_t socket = client();
  ASSERT_TRUE(begin(socket, encodeProblem(problem_)).has_follow_reply());
  for (int n = 0; n < 3; ++n) {
    hand_.displacement[0] -= 0.001;
    const wire::Message reply = follow(socket, hand_);
    ASSERT_TRUE(reply.has_followed());
    const auto followed = fromWire(reply.followed());
    ASSERT_TRUE(followed && followed->converged());
    EXPECT_EQ(followed->expansion().displacement, hand_.displacement);
    EXPECT_GT(followed->expansion().equilibrium.force[0], 0);
  }
}

TEST_F(FollowServerTest, AnswersWithTheForceOnASecondFingerThatHolds) {
  zmq::socket_t socket = client();
  ASSERT_TRUE(begin(socket, encodeProblem(problem_)).has_follow_reply());
  const Eigen::Vector3d place =
      fingerNear("test", problem_.mesh, {0.02, 0.1, -0.05}, served_radius).center;
  hand_.hold = Hold{place, {0, -0.005, 0}};
  const auto followed = fromWire(follow(socket, hand_).followed());
  ASSERT_TRUE(followed && followed->converged());
  const Expansion& expansion = followed->expansion();
  ASSERT_TRUE(expansion.held);
  EXPECT_LT((expansion.held->at.place - place).norm(), 1e-9);
  EXPECT_GT(expansion.held->force[1], 0);
  EXPECT_LT(expansion.held->stiffness(1, 1), 0);
}

TEST_F(FollowServerTest, SaysThatThereIsNoEquilibriumAndGoesOn) {
  zmq::socket_t socket = client();
  begin(socket, encodeProblem(problem_));
  HandMotion held = hand_;
  held.place = problem_.mesh.nodes[static_cast<std::size_t>(problem_.fixed.front())];
  const wire::Message reply = follow(socket, held);
  const auto none = fromWire(reply.followed());
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->converged());
  EXPECT_FALSE(reply.followed().objection().empty());
  hand_.hold = Hold{held.place, {0, -0.005, 0}};
  const std::string of_hold = follow(socket, hand_).followed().objection();
  EXPECT_FALSE(of_hold.empty());
  EXPECT_NE(of_hold, reply.followed().objection()) << "it names the hold, not the hand";
  hand_.hold = Hold{{0.02, 0.1, -0.05}, {0, -9, 0}};
  EXPECT_FALSE(follow(socket, hand_).followed().objection().empty()) << "far outside the body";
  hand_.hold = std::nullopt;
  EXPECT_TRUE(fromWire(follow(socket, hand_).followed())->converged());
}

TEST_F(FollowServerTest, RefusesASecondClientUntilTheFirstIsSilent) {
  zmq::socket_t first = client(), second = client();
  const std::string problem = encodeProblem(problem_);
  ASSERT_TRUE(begin(first, problem).has_follow_reply());
  EXPECT_TRUE(begin(second, problem).has_refused());
  EXPECT_FALSE(follow(second, hand_).has_followed());
  EXPECT_TRUE(follow(first, hand_).has_followed());
}

TEST_F(FollowServerTest, AcceptsAnotherClientAfterAGoodbye) {
  zmq::socket_t first = client(), second = client();
  const std::string problem = encodeProblem(problem_);
  ASSERT_TRUE(begin(first, problem).has_follow_reply());
  wire::Message farewell;
  farewell.mutable_goodbye();
  EXPECT_EQ(sendMessage(first, "", farewell), Sent::yes);
  server_.turn(1s);
  EXPECT_TRUE(begin(second, problem).has_follow_reply());
  EXPECT_FALSE(follow(first, hand_).has_followed());
}

TEST_F(FollowServerTest, RefusesAnotherProtocolAndADamagedProblem) {
  zmq::socket_t socket = client();
  const std::string problem = encodeProblem(problem_);
  EXPECT_TRUE(begin(socket, problem, protocol_version + 1).has_refused());
  EXPECT_TRUE(begin(socket, problem.substr(0, problem.size() / 2)).has_refused());
  EXPECT_TRUE(begin(socket, problem).has_follow_reply());
}

TEST_F(FollowServerTest, RefusesABodyWithoutAStateAtRest) {
  problem_.scene.gravity = {0, 0, -1e6};
  problem_.scene.regions[0].material.density = 1000;
  zmq::socket_t socket = client();
  EXPECT_TRUE(begin(socket, encodeProblem(problem_)).has_refused());
}

TEST_F(FollowServerTest, IgnoresAHandWhoseNumbersMakeNoSense) {
  zmq::socket_t socket = client();
  begin(socket, encodeProblem(problem_));
  HandMotion hand = hand_;
  hand.place[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(follow(socket, hand).has_followed());
  EXPECT_TRUE(follow(socket, hand_).has_followed());
}

}  // namespace
}  // namespace palpate
