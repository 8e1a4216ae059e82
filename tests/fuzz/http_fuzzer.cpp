#include <arpa/inet.h>
#include <sys/socket.h>

#include "common/base/file_descriptor.hpp"
#include "scheduler/web/http_server.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {
namespace {

/// The parameters that the pages of a scheduler read.
HttpAnswer answerOf(const HttpQuery& query) {
  std::string body;
  for (const auto& [name, value] : query) body += name + '=' + value + '\n';
  return {.status = 200, .type = "text/plain", .body = body, .headers = {}};
}

int portOfServer() {
  static const HttpServer server({}, {{"/", answerOf}, {"/events.json", answerOf}}, "--dashboard");
  return server.address().port;
}

sockaddr_in onThisMachine(std::uint32_t host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(host);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

FileDescriptor connected() {
  FileDescriptor file(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  // A closed connection keeps its pair of addresses for a minute, and there are many connections.
  static std::uint32_t host = INADDR_LOOPBACK;
  host = INADDR_LOOPBACK + (host + 1) % (1 << 23);
  const sockaddr_in from = onThisMachine(host, 0);
  const sockaddr_in to = onThisMachine(INADDR_LOOPBACK, portOfServer());
  // Longer than any timeout of the server.
  const timeval patience{8, 0};
  if (!file || bind(file.get(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0 ||
      setsockopt(file.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0 ||
      connect(file.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    throw failure("no connection: {}", errnoText());
  return file;
}

/// An option of a command line, and a connection that sends it.
void askOverHttp(std::string_view bytes) {
  try {
    const std::string text(bytes.substr(0, bytes.find('\n')));
    const HttpAddress address = HttpAddress::parse(text, "--metrics");
    require(HttpAddress::parse(address.text(), "").text() == address.text(),
            "an address is not read as it was written");
  } catch (const Error&) {
    // Most inputs are invalid options.
  }
  const FileDescriptor file = connected();
  // The server may refuse before it has read everything.
  static_cast<void>(send(file.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL));
  shutdown(file.get(), SHUT_WR);
  std::string answer;
  char buffer[4096];
  ssize_t count = 0;
  // libFuzzer's timer interrupts calls with a time limit, even with SA_RESTART.
  while ((count = recv(file.get(), buffer, sizeof buffer, 0)) > 0 || (count < 0 && errno == EINTR))
    if (count > 0) answer.append(buffer, static_cast<std::size_t>(count));
  require(count == 0 || errno == ECONNRESET, "a connection is never closed");
  require(answer.empty() || answer.starts_with("HTTP/1."), "an answer is one of HTTP");
}

std::vector<std::string> requestSeeds() {
  const std::string host = "Host: localhost\r\n\r\n";
  return {"GET / HTTP/1.1\r\n" + host,
          "GET /events.json?last=20&event=a,b HTTP/1.1\r\n" + host,
          "GET /events.json?last=%32%30&event=%ff%00+x HTTP/1.0\r\n" + host,
          "GET http://[::1]:9/?a=1#b HTTP/1.1\r\nHost: [::1]:9\r\nSec-Fetch-Site: none\r\n\r\n",
          "POST / HTTP/1.1\r\nContent-Length: 3\r\n" + host + "abc",
          "HEAD / HTTP/1.1\r\nRange: bytes=0-5\r\nAccept-Encoding: gzip\r\n" + host,
          "PUT / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n" + host + "3\r\nabc\r\n0\r\n\r\n",
          "127.0.0.1:9464\n",
          "[::1]:80\n",
          "node7:0\n"};
}

const Registration http_fuzzer({"http", askOverHttp, requestSeeds,
                                [] { static_cast<void>(portOfServer()); }});

}  // namespace
}  // namespace palpate::fuzz
