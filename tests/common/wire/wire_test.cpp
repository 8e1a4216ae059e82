#include "common/wire/wire.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

TEST(Endpoint, IsAHostAndAPortOrAPath) {
  for (const char* good : {"tcp://127.0.0.1:7411", "tcp://localhost:1", "tcp://[::1]:65535",
                           "tcp://*:7411", "tcp://127.0.0.1:*", "ipc:///run/palpate"})
    EXPECT_NO_THROW(checkEndpoint(good)) << good;
}

TEST(Endpoint, IsRefusedSayingHowToWriteOne) {
  for (const char* bad :
       {"", "localhost:7411", "http://localhost:7411", "tcp://", "tcp://localhost", "tcp://:7411",
        "tcp://localhost:", "tcp://localhost:99999", "tcp://localhost:7411x"})
    expectBadInput([&] { checkEndpoint(bad); }, {"tcp://HOST:PORT"});
}

}  // namespace
}  // namespace palpate
