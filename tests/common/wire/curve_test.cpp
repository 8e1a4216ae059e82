#include "common/wire/curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/wire/wire.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// A server, and clients with their own keys.
struct CurveTest : testing::Test {
  test::TemporaryDirectory directory;
  const KeyFolder server_keys{directory / "server"}, client_keys{directory / "client"};
  zmq::context_t context;
  std::optional<ZapHandler> zap_handler;
  zmq::socket_t server = makeRouter(context);
  std::string endpoint;

  void SetUp() override {
    client_keys.ownOrNew();
    listen(true);
  }
  void listen(bool with_keys) {
    server = makeRouter(context);
    zap_handler.reset();
    if (with_keys) zap_handler.emplace(context, server, server_keys);
    endpoint = bindRouter(server, "tcp://127.0.0.1:*");
  }
  void TearDown() override { server.close(); }
  PublicKey client() const { return client_keys.own().open(); }

  /// The outcome of a message from a client with or without these keys.
  struct Outcome {
    std::optional<Incoming> incoming;
    std::string trouble;
  };
  Outcome say(const std::optional<KeyFolder>& keys) {
    zmq::context_t elsewhere;
    zmq::socket_t socket = makeDealer(elsewhere);
    socket.set(zmq::sockopt::immediate, false);
    if (keys) proveAsClient(socket, *keys, endpoint);
    HandshakeWatch handshakes(elsewhere, socket);
    EXPECT_EQ(connectDealer(socket, endpoint), "");
    wire::Message message;
    message.mutable_status_request();
    EXPECT_EQ(sendMessage(socket, "", message), Sent::yes);
    Outcome outcome;
    for (int tries = 0; tries < 1000; ++tries) {
      waitForMessages(server, 10ms);
      outcome.incoming = receiveMessage(server, true);
      outcome.trouble = handshakes.trouble();
      if (outcome.incoming || !outcome.trouble.empty()) return outcome;
    }
    ADD_FAILURE() << "neither a message nor a reason";
    return outcome;
  }
  void expectTrouble(const std::optional<KeyFolder>& keys, const std::string& words) {
    const Outcome outcome = say(keys);
    EXPECT_FALSE(outcome.incoming);
    EXPECT_THAT(outcome.trouble, HasSubstr(words));
  }
};

TEST_F(CurveTest, MessagesCarryTheKeyOfTheirSender) {
  server_keys.allow({client(), rolesOf("observer"), "me"});
  client_keys.trust(server_keys.own().open(), endpoint);
  listen(true);
  client_keys.trust(server_keys.own().open(), endpoint);
  const Outcome outcome = say(client_keys);
  ASSERT_TRUE(outcome.incoming) << outcome.trouble;
  EXPECT_TRUE(outcome.incoming->message.has_status_request());
  EXPECT_EQ(outcome.incoming->key, client());
  EXPECT_EQ(zap_handler->rolesOf(outcome.incoming->key), rolesOf("observer"));
}

TEST_F(CurveTest, TheServersOwnKeyFolderIsAdmittedWithoutAList) {
  const Outcome outcome = say(server_keys);
  ASSERT_TRUE(outcome.incoming) << outcome.trouble;
  EXPECT_EQ(zap_handler->rolesOf(outcome.incoming->key), Roles::all);
}

TEST_F(CurveTest, AnUnknownKeyIsRefusedWithTheReason) {
  client_keys.trust(server_keys.own().open(), "*");
  expectTrouble(client_keys, "does not admit this key");
}

TEST_F(CurveTest, AServerWithAnUnexpectedKeyIsRefused) {
  server_keys.allow({client(), rolesOf("observer"), "me"});
  client_keys.trust(KeyPair::make().open(), "*");
  expectTrouble(client_keys, "its key differs");
}

TEST_F(CurveTest, AKeyOnOnlyOneSideIsReported) {
  expectTrouble(std::nullopt, "--insecure");
  listen(false);
  expectTrouble(client_keys, "--insecure");
}

TEST_F(CurveTest, MessagesCarryNoKeyWithoutKeys) {
  listen(false);
  const Outcome outcome = say(std::nullopt);
  ASSERT_TRUE(outcome.incoming) << outcome.trouble;
  EXPECT_FALSE(outcome.incoming->key);
}

TEST_F(CurveTest, AKeyIsCreatedForThisMachineOnly) {
  const KeyFolder none(directory / "none");
  zmq::socket_t socket = makeDealer(context);
  test::expectBadInput([&] { proveAsClient(socket, none, "tcp://head:7411"); },
                       {"none", "palpate key new"});
  EXPECT_FALSE(none.hasOwn());
  proveAsClient(socket, none, "tcp://127.0.0.1:7411");
  EXPECT_TRUE(none.hasOwn());
}

}  // namespace
}  // namespace palpate
