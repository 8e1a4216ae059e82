#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// Address to listen on.
struct HttpAddress {
  std::string host = "127.0.0.1";  ///< a name or an IP address; IPv6 without brackets
  int port = 0;                    ///< 0 lets the system choose a port

  /// Parses "PORT", "HOST:PORT" or "[IPV6]:PORT". Throws Error (bad input), naming `option`, if the
  /// text is none of these.
  static HttpAddress parse(const std::string& text, const char* option);
  /// Returns true if only this machine can reach the address.
  bool isLoopback() const;
  std::string text() const;
};

struct HttpAnswer {
  int status = 200;
  std::string type;  ///< such as "application/json"
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers = {};
};
using HttpQuery = std::map<std::string, std::string>;
/// Answers a request from its parsed query string. Several threads may call a handler at the same
/// time. If it throws, the answer has the message of the exception, and the status 400 (Error of
/// bad input) or 500.
using HttpHandler = std::function<HttpAnswer(const HttpQuery&)>;

/// Returns a JSON object with the field "error".
HttpAnswer httpError(int status, const std::string& what);

/// Answers GET requests in its own threads, which have signals blocked and low priority (nice).
///
/// Limits protect the scheduler from its clients:
/// - At most `threads` requests run at a time. The same number of further connections is accepted
///   and waits; all others wait in the kernel.
/// - Each connection is closed after its answer, or after 5 s of silence.
/// - Request bodies, and header lines beyond 8 KiB, are refused.
/// - On a loopback address the Host header must name this machine. Otherwise a web page could reach
///   the server through a host name of its own (DNS rebinding).
/// - Requests that a browser sends for a page of another origin are refused.
class HttpServer {
 public:
  static constexpr std::size_t threads = 4;

  /// Starts to listen. The keys of `handlers` are paths, such as "/metrics". Throws Error, naming
  /// `option`, if the address is in use or does not belong to this machine.
  HttpServer(const HttpAddress& address, const std::map<std::string, HttpHandler>& handlers,
             const char* option);
  /// Stops listening, waits for the running handlers, and ends the threads.
  ~HttpServer();

  /// Returns the address, with the port that was chosen.
  const HttpAddress& address() const;
  std::string url() const { return "http://" + address().text() + "/"; }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate
