#include "scheduler/web/http_server.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <thread>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/http_get.hpp"

namespace palpate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct HttpServerTest : testing::Test {
  HttpServer server{{.host = "127.0.0.1", .port = 0},
                    {{"/hello", [](const HttpQuery& query) { return greet(query); }},
                     {"/wrong", [](const HttpQuery&) -> HttpAnswer { throw badInput("no \"x\""); }},
                     {"/broken", [](const HttpQuery&) -> HttpAnswer { throw failure("no disk"); }}},
                    "--metrics"};

  static HttpAnswer greet(const HttpQuery& query) {
    const auto who = query.find("who");
    return {.status = 200,
            .type = "text/plain",
            .body = "hello " + (who == query.end() ? std::string("you") : who->second),
            .headers = {{"Age", "3"}}};
  }
  int port() const { return server.address().port; }
  std::string get(const std::string& path, const std::string& headers = "") const {
    return test::httpGet(port(), path, headers);
  }
};

TEST_F(HttpServerTest, AnswersGetWithItsHandlersReply) {
  EXPECT_THAT(get("/hello"),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\r\nAge: 3\r\n"), HasSubstr("nosniff"),
                    HasSubstr("no-store"), HasSubstr("\r\n\r\nhello you")));
  EXPECT_EQ(test::bodyOf(get("/hello?who=a%26b")), "hello a&b");
  EXPECT_EQ(server.url(), "http://127.0.0.1:" + std::to_string(port()) + "/");
}

TEST_F(HttpServerTest, ExplainsErrors) {
  EXPECT_THAT(get("/elsewhere"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/wrong"),
              AllOf(StartsWith("HTTP/1.1 400"), HasSubstr(R"({"error":"no \"x\""})")));
  EXPECT_THAT(get("/broken"), AllOf(StartsWith("HTTP/1.1 500"), HasSubstr("no disk")));
}

TEST_F(HttpServerTest, AnswersOnlyGet) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "HEAD", "PATCH"})
    EXPECT_THAT(
        test::httpAnswer(port(), std::string(method) + " /hello HTTP/1.1\r\nHost: localhost\r\n"
                                                       "Content-Length: 0\r\n\r\n"),
        AllOf(Not(HasSubstr("200")), Not(HasSubstr("hello"))))
        << method;
}

/// A web page may have a host name that resolves to this machine; it must not read this server.
TEST_F(HttpServerTest, RefusesForeignHostNames) {
  for (const char* host : {"evil.example", "evil.example:80", "", "127.evil.example:1",
                           "localhost.evil.example", "[::1].evil.example"})
    EXPECT_THAT(get("/hello", std::string("Host: ") + host + "\r\n"), StartsWith("HTTP/1.1 403"))
        << host;
  EXPECT_THAT(test::httpAnswer(port(), "GET /hello HTTP/1.0\r\n\r\n"), HasSubstr("403"));
  for (const char* host : {"localhost", "LOCALHOST:8080", "127.0.0.1:1", "[::1]:1"})
    EXPECT_THAT(get("/hello", std::string("Host: ") + host + "\r\n"), StartsWith("HTTP/1.1 200"))
        << host;
}

TEST_F(HttpServerTest, RefusesPagesOfOtherOrigins) {
  EXPECT_THAT(get("/hello", "Sec-Fetch-Site: cross-site\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/hello", "Sec-Fetch-Site: same-site\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("/hello", "Sec-Fetch-Site: same-origin\r\n"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get("/hello"), Not(HasSubstr("Access-Control")));
}

TEST_F(HttpServerTest, LongLinesAreRefused) {
  EXPECT_THAT(get("/hello?who=" + std::string(20000, 'x')), Not(HasSubstr("200 OK")));
  EXPECT_THAT(get("/hello", "X: " + std::string(20000, 'x') + "\r\n"), Not(HasSubstr("200 OK")));
  EXPECT_THAT(get("/hello"), HasSubstr("200 OK")) << "others are still served";
}

TEST_F(HttpServerTest, SilentClientsDoNotBlockOthers) {
  std::vector<std::thread> silent;
  for (std::size_t n = 0; n + 1 < HttpServer::threads; ++n)
    silent.emplace_back([this] { test::httpAnswer(port(), "GET /hel"); });
  EXPECT_THAT(get("/hello"), HasSubstr("200 OK"));
  for (std::thread& thread : silent) thread.join();
}

/// Thousands of descriptors of workers come first.
TEST_F(HttpServerTest, AnswersWithThousandsOfOpenDescriptors) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max < 1500) GTEST_SKIP() << "this machine allows too few descriptors";
  const rlimit before = limit;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  std::vector<FileDescriptor> many;
  for (int n = 0; n < 1200; ++n) many.emplace_back(open("/dev/null", O_RDONLY | O_CLOEXEC));
  ASSERT_GT(many.back().get(), 1024);
  EXPECT_THAT(get("/hello"), HasSubstr("200 OK"));
  many.clear();
  setrlimit(RLIMIT_NOFILE, &before);
}

TEST_F(HttpServerTest, APortInUseIsRefused) {
  test::expectError(ExitCode::failed, [&] { HttpServer(server.address(), {}, "--metrics"); },
                    {"--metrics", server.address().text(), "in use"});
}

TEST(HttpAddress, IsAPortOrAHostAndAPort) {
  EXPECT_EQ(HttpAddress::parse("9464", "--metrics").text(), "127.0.0.1:9464");
  EXPECT_EQ(HttpAddress::parse("0.0.0.0:9464", "--metrics").text(), "0.0.0.0:9464");
  EXPECT_EQ(HttpAddress::parse("[::1]:0", "--metrics").host, "::1");
  EXPECT_TRUE(HttpAddress::parse("[::1]:0", "--metrics").isLoopback());
  EXPECT_TRUE(HttpAddress::parse("localhost:1", "--metrics").isLoopback());
  EXPECT_FALSE(HttpAddress::parse("0.0.0.0:1", "--metrics").isLoopback());
  for (const char* none : {"", "x", "host:", ":1", "::1:9", "1.2.3.4:70000", "http://a:1", "-1"})
    test::expectBadInput([&] { HttpAddress::parse(none, "--metrics"); },
                         {"--metrics", "HOST:PORT"});
}

}  // namespace
}  // namespace palpate
