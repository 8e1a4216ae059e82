#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// Where to listen.
struct HttpAddress {
  std::string host = "127.0.0.1";  ///< a name or a number; that of IPv6 without brackets
  int port = 0;                    ///< 0: the system chooses

  /// "PORT", "HOST:PORT" or "[IPV6]:PORT". Error (bad input) that names `option` when it is none.
  static HttpAddress parse(const std::string& text, const char* option);
  /// Whether nobody but this machine reaches it.
  bool isLoopback() const;
  std::string text() const;
};

struct HttpAnswer {
  int status = 200;
  std::string type;  ///< "application/json"
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;
};
using HttpQuery = std::map<std::string, std::string>;
/// From what follows the ? of the address. Called by several threads at a time. What it throws
/// becomes an answer of status 400 (Error of bad input) or 500 with the message.
using HttpHandler = std::function<HttpAnswer(const HttpQuery&)>;

/// An object with the field "error".
HttpAnswer httpError(int status, const std::string& what);

/// Answers GET in threads of its own, which see no signals and stand behind other work (nice).
///
/// A scheduler is not to suffer from who asks: at most `threads` requests are in work, as many
/// more connections are taken and wait, and others wait in the kernel; each is closed after its
/// answer, and given up when it says nothing for 5 s. What follows a header, and lines of it beyond
/// 8 KiB, are refused. On a loopback address only requests that name this machine in their Host are
/// answered, so that no page of the web reaches it by a name of its own (DNS rebinding); requests
/// that a browser sends for a page of another origin are refused.
class HttpServer {
 public:
  static constexpr std::size_t threads = 4;

  /// Listens from now on. `handlers` by path, "/metrics". Error when the address is in use or none
  /// of this machine's; it names `option`.
  HttpServer(const HttpAddress& address, const std::map<std::string, HttpHandler>& handlers,
             const char* option);
  /// Ends the threads; waits for those that answer.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// With the port that was chosen.
  const HttpAddress& address() const;
  std::string url() const { return "http://" + address().text() + "/"; }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate
