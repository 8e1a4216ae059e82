#include "common/wire/wire.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/causes.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/same_records.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

TEST(Endpoint, IsAHostAndAPortOrAPath) {
  for (const char* good : {"tcp://127.0.0.1:7411", "tcp://localhost:1", "tcp://[::1]:65535",
                           "tcp://*:7411", "tcp://127.0.0.1:*", "ipc:///run/palpate"})
    EXPECT_NO_THROW(checkEndpoint(good)) << good;
}

TEST(Endpoint, IsRefusedWithAnExampleIfInvalid) {
  for (const char* bad :
       {"", "localhost:7411", "http://localhost:7411", "tcp://", "tcp://localhost", "tcp://:7411",
        "tcp://localhost:", "tcp://localhost:99999", "tcp://localhost:7411x"})
    expectBadInput([&] { checkEndpoint(bad); }, {"tcp://HOST:PORT"});
  expectBadInput([&] { checkEndpoint("ipc:///" + std::string(107, 'x')); }, {"107"});
}

/// Returns whether messages of `dealer` to `endpoint` reach `router`.
bool isHeard(zmq::socket_t& router, zmq::socket_t& dealer, const std::string& endpoint) {
  dealer.set(zmq::sockopt::immediate, false);
  EXPECT_EQ(connectDealer(dealer, endpoint), "");
  wire::Message question;
  question.mutable_status_request();
  EXPECT_EQ(sendMessage(dealer, "", question), Sent::yes);
  for (int wait = 0; wait < 100; ++wait) {
    if (receiveMessage(router, true)) return true;
    waitForMessages(router, std::chrono::milliseconds(100));
  }
  return false;
}

TEST(Messages, AreNotCopiedAndKeepTheirDataUntilSent) {
  zmq::context_t context;
  zmq::socket_t router = makeRouter(context);
  zmq::socket_t peer(context, zmq::socket_type::dealer);
  peer.set(zmq::sockopt::linger, 0);
  peer.set(zmq::sockopt::rcvhwm, 1);
  peer.set(zmq::sockopt::rcvbuf, 65536);
  peer.connect(bindRouter(router, "tcp://127.0.0.1:*"));
  wire::Message question, reply;
  question.mutable_problem_request();
  reply.mutable_problem_reply();
  ASSERT_EQ(sendMessage(peer, "", question), Sent::yes);
  waitForMessages(router, std::chrono::seconds(10));
  const auto asked = receiveMessage(router, true);
  ASSERT_TRUE(asked);
  const auto payload = std::make_shared<const std::string>(16 << 20, 'x');
  const auto held = std::make_shared<int>(0);
  for (int n = 0; n < 2; ++n)
    ASSERT_EQ(sendMessage(router, asked->peer, reply, payload, held), Sent::yes);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_GT(payload.use_count(), 1) << "it is not copied";
  EXPECT_GT(held.use_count(), 1) << "the peer reads nothing of the second";
  for (int n = 0; n < 2;) {
    waitForMessages(peer, std::chrono::seconds(10));
    if (const auto read = receiveMessage(peer, false)) {
      EXPECT_EQ(read->payload.size(), payload->size());
      ++n;
    }
  }
  for (int n = 0; n < 1000 && held.use_count() > 1; ++n)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(held.use_count(), 1);
}

/// The endpoint of a router that listens at `endpoint`, with the given host name.
std::string namedAs(const std::string& host, const std::string& endpoint) {
  return "tcp://" + host + endpoint.substr(endpoint.rfind(':'));
}

TEST(Endpoint, AcceptsHostNamesForServersAndClients) {
  std::array<char, 256> own_name{};
  ASSERT_EQ(gethostname(own_name.data(), own_name.size() - 1), 0);
  for (const std::string& host : {std::string("localhost"), std::string(own_name.data())}) {
    zmq::context_t context;
    zmq::socket_t router = makeRouter(context), dealer = makeDealer(context);
    const std::string endpoint = bindRouter(router, "tcp://" + host + ":*");
    EXPECT_TRUE(isHeard(router, dealer, namedAs(host, endpoint))) << host;
  }
}

TEST(Endpoint, AcceptsAHostWithOnlyAnIPv6Address) {
  zmq::context_t context;
  zmq::socket_t router = makeRouter(context), dealer = makeDealer(context);
  std::string endpoint;
  try {
    endpoint = bindRouter(router, "tcp://[::1]:*");
  } catch (const Error& error) {
    GTEST_SKIP() << error.what() << ": IPv6 was NOT tested";
  }
  // Without brackets the address is looked up like a name.
  EXPECT_TRUE(isHeard(router, dealer, namedAs("::1", endpoint)));
  zmq::socket_t other = makeDealer(context);
  EXPECT_TRUE(isHeard(router, other, endpoint));
}

TEST(Endpoint, AnUnknownHostIsReportedAtOnce) {
  const std::string unknown = "tcp://nowhere.invalid:7411";
  zmq::context_t context;
  zmq::socket_t router = makeRouter(context), dealer = makeDealer(context);
  EXPECT_NE(connectDealer(dealer, unknown).find("nowhere.invalid not found"), std::string::npos);
  test::expectError(ExitCode::failed, [&] { bindRouter(router, unknown); }, {"not found"});
}

/// libzmq itself would take the path over without notice to the first listener.
TEST(Endpoint, ASocketFileInUseIsRefused) {
  const test::TemporaryDirectory directory;
  const std::string endpoint = "ipc://" + (directory / "s").string();
  zmq::context_t context;
  zmq::socket_t second = makeRouter(context);
  {
    zmq::context_t first_context;
    zmq::socket_t first = makeRouter(first_context);
    bindRouter(first, endpoint);
    test::expectError(ExitCode::failed, [&] { bindRouter(second, endpoint); },
                      {endpoint, "in use by another program", "another path"});
    zmq::socket_t dealer = makeDealer(context);
    EXPECT_TRUE(isHeard(first, dealer, endpoint));
  }
  EXPECT_TRUE(std::filesystem::exists(directory / "s"));
  EXPECT_EQ(bindRouter(second, endpoint), endpoint) << "once the first has ended";
}

/// The state after a kill: the file exists, but nobody listens.
TEST(Endpoint, AStaleSocketFileIsReplaced) {
  const test::TemporaryDirectory directory;
  const std::string path = directory / "s";
  struct sockaddr_un address {};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  const int killed = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(killed, reinterpret_cast<struct sockaddr*>(&address), sizeof address), 0);
  close(killed);
  ASSERT_TRUE(std::filesystem::exists(path));
  zmq::context_t context;
  zmq::socket_t socket = makeRouter(context);
  EXPECT_EQ(bindRouter(socket, "ipc://" + path), "ipc://" + path);
}

TEST(Endpoint, AFileThatIsNotASocketIsRefusedAndKept) {
  const test::TemporaryDirectory directory;
  const std::string path = directory / "thesis.tex";
  std::ofstream(path) << "years of work";
  zmq::context_t context;
  zmq::socket_t socket = makeRouter(context);
  test::expectError(ExitCode::failed, [&] { bindRouter(socket, "ipc://" + path); },
                    {path, "not a socket"});
  EXPECT_EQ(std::filesystem::file_size(path), 13u);
  expectBadInput([&] { bindRouter(socket, "ipc://" + std::string(200, 'x')); }, {"too long"});
}

TEST(WireResult, CarriesFailuresOfEveryCauseThatStopsTransitions) {
  for (const Cause cause : test::allCauses()) {
    if (!stopsTransitions(cause)) continue;
    const Outcome outcome = {Failure{cause, 0.75, 2e-3, 11, 0.125, 28, 27, -9, 4096}, {}};
    wire::Result result;
    toWire(outcome, "", result);
    const auto again = fromWire(result);
    ASSERT_TRUE(again) << name(cause);
    EXPECT_EQ(again->failure().cause, cause);
    EXPECT_EQ(describe(again->failure()), describe(outcome.failure()));
  }
}

TEST(WireResult, CarriesConfigurationalForcesForFingersOnly) {
  Outcome outcome = {Configuration(), {}};
  wire::Result plain;
  toWire(outcome, "fields", plain);
  EXPECT_TRUE(plain.equilibrium().drive().empty());
  Equilibrium& e = outcome.configuration().equilibrium;
  e.drive = {1, -2, 3};
  e.drive_stiffness << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  e.drive_slope = Eigen::Matrix3d::Identity();
  e.stiffness_by_p(2, 1) = 4;
  e.stiffness_by_s(0, 2) = 5;
  e.drive_slope_by_p(5, 0) = 6;
  wire::Result result;
  toWire(outcome, "fields", result);
  const auto again = fromWire(result);
  ASSERT_TRUE(again);
  test::expectSame(again->equilibrium(), outcome.equilibrium());
  result.mutable_equilibrium()->set_drive("short");
  EXPECT_FALSE(fromWire(result));
}

TEST(WireResult, ImpossibleNumbersAreRefused) {
  const auto taken = [](auto&& change) {
    Configuration found;
    change(found.equilibrium);
    wire::Result result;
    toWire({found, {}}, "fields", result);
    return fromWire(result).has_value();
  };
  EXPECT_TRUE(taken([](Equilibrium& e) { e.force[2] = 1e29; }));
  EXPECT_FALSE(taken([](Equilibrium& e) { e.force[2] = -1e31; }));
  EXPECT_FALSE(taken([](Equilibrium& e) { e.stiffness(1, 1) = NAN; }));
  EXPECT_FALSE(taken([](Equilibrium& e) { e.energy = INFINITY; }));
  EXPECT_FALSE(taken([](Equilibrium& e) { e.drive_slope_by_p(5, 2) = 1e300; }));
}

TEST(WireResult, UnknownCausesAreRefused) {
  for (const std::uint32_t value :
       {0u, static_cast<std::uint32_t>(Cause::unreachable), 200u, 257u}) {
    wire::Result result;
    result.mutable_failure()->set_cause(value);
    EXPECT_FALSE(fromWire(result)) << value;
  }
}

TEST(WireFollowing, CarriesHandsAndTheEquilibriaNearThem) {
  const HandMotion hand = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
  wire::HandMotion of_hand;
  toWire(hand, of_hand);
  const auto read = fromWire(of_hand);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->displacement_speed, hand.displacement_speed);
  EXPECT_EQ(read->place, hand.place);
  of_hand.mutable_place()->resize(5);
  EXPECT_FALSE(fromWire(of_hand));

  Followed followed{Expansion{{1, 2, 3}, {4, 5, 6}, {}}, {.newton_iterations = 7}};
  std::get<Expansion>(followed.end).equilibrium.drive = {1, 0, 2};
  wire::Followed of_followed;
  toWire(followed, of_followed);
  const auto found = fromWire(of_followed);
  ASSERT_TRUE(found && found->converged());
  EXPECT_EQ(found->expansion().displacement, followed.expansion().displacement);
  EXPECT_EQ(found->expansion().equilibrium.drive, Eigen::Vector3d(1, 0, 2));
  EXPECT_EQ(found->cost.newton_iterations, 7);
  of_followed.mutable_equilibrium()->set_energy(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(fromWire(of_followed));
}

TEST(WireFollowing, CarriesWhyThereIsNoEquilibrium) {
  wire::Followed message;
  toWire(Followed{Failure{.cause = Cause::inverted_element}, {}}, message);
  const auto failed = fromWire(message);
  ASSERT_TRUE(failed && !failed->converged());
  EXPECT_EQ(failed->failure().cause, Cause::inverted_element);
  EXPECT_FALSE(fromWire(wire::Followed{}));
}

}  // namespace
}  // namespace palpate
