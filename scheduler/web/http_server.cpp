#include "scheduler/web/http_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/machine.hpp"
#include "common/base/number_in.hpp"

#undef _res  // a macro of <resolv.h>; Eigen, in other files of this unity build, uses the name

namespace palpate {
namespace {

/// Starts a thread that lets the scheduler run first if there is only one core. All its signals are
/// blocked, since the main thread handles them.
std::thread quietThread(std::function<void()> run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread([run = std::move(run)] {
    giveWay();
    run();
  });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

/// Thread pool with a bounded queue. If 2 * HttpServer::threads connections wait or are being
/// answered, enqueue() blocks, so that the listener accepts no more. The pool never drops an
/// accepted connection, because nobody would close it. The listener creates the pool, so the pool's
/// threads inherit the listener's signal mask and niceness.
class BoundedPool : public httplib::TaskQueue {
 public:
  /// The result of enqueue(): void, or in newer versions of cpp-httplib bool (true: accepted).
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue(nullptr));
  Taken enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return taken_ < 2 * HttpServer::threads; });
    ++taken_;
    return pool_.enqueue([this, task = std::move(task)] {
      task();
      const std::lock_guard done(mutex_);
      --taken_;
      changed_.notify_all();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t taken_ = 0;
  httplib::ThreadPool pool_{HttpServer::threads};
};

/// Returns true if a name or an IP address (IPv6 without brackets) is loopback.
bool namesLoopback(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  in_addr number{};
  return name == "localhost" || name == "::1" ||
         (name.starts_with("127.") && inet_pton(AF_INET, name.c_str(), &number) == 1);
}

/// Returns the name in a Host header: "localhost:80" gives "localhost", "[::1]" gives "::1". Empty
/// if the header is invalid.
std::string nameIn(const std::string& host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string::npos) return "";
  const std::size_t end = std::min(host.find(':', bracket), host.size());
  if (end < host.size() && !numberIn<std::uint16_t>(std::string_view(host).substr(end + 1)))
    return "";
  if (bracket == 0) return host.substr(0, end);
  return end == bracket + 1 ? host.substr(1, bracket - 1) : "";
}

HttpAnswer answerOf(const HttpHandler& handler, const HttpQuery& query) {
  try {
    return handler(query);
  } catch (const Error& error) {
    return httpError(error.exitCode() == ExitCode::usage ? 400 : 500, error.what());
  } catch (const std::exception& error) {
    return httpError(500, error.what());
  }
}

void fill(httplib::Response& response, const HttpAnswer& answer) {
  response.status = answer.status;
  response.set_content(answer.body, answer.type);
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
}

}  // namespace

HttpAddress HttpAddress::parse(const std::string& text, const char* option) {
  HttpAddress address;
  const std::size_t colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "" : text.substr(0, colon);
  const auto port = numberIn<std::uint16_t>(
      std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1));
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  if (!port || (colon != std::string::npos && host.empty()) ||
      (!bracketed && host.find(':') != std::string::npos) || host.find('/') != std::string::npos)
    throw badInput("{} \"{}\": give PORT, HOST:PORT or [IPV6]:PORT, for instance 127.0.0.1:9464",
                   option, text);
  if (!host.empty()) address.host = host;
  address.port = *port;
  return address;
}

bool HttpAddress::isLoopback() const { return namesLoopback(host); }

std::string HttpAddress::text() const {
  return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port)
                                             : fmt::format("[{}]:{}", host, port);
}

HttpAnswer httpError(int status, const std::string& what) {
  return {.status = status,
          .type = "application/json",
          .body = nlohmann::json{{"error", what}}.dump(-1, ' ', false,
                                                       nlohmann::json::error_handler_t::replace)};
}

struct HttpServer::Parts {
  HttpAddress address;
  httplib::Server server;
  std::thread listener;
  std::atomic<bool> ended = false;

  /// Returns the reason to refuse this request; empty if it is allowed.
  std::string objectionTo(const httplib::Request& request) const {
    if (request.method != "GET") return "only GET requests are answered";
    if (address.isLoopback() && !namesLoopback(nameIn(request.get_header_value("Host"))))
      return "only requests for localhost are answered";
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    if (!site.empty() && site != "same-origin" && site != "none")
      return "requests from pages of other sites are refused";
    return "";
  }
  void limit();
  void answer(const std::string& path, const HttpHandler& handler);
  void bind(const char* option);
};

void HttpServer::Parts::limit() {
  constexpr std::time_t patience_s = 5;
  server.new_task_queue = [] { return new BoundedPool; };
  server.set_keep_alive_max_count(1);
  server.set_read_timeout(patience_s, 0);
  server.set_write_timeout(patience_s, 0);
  server.set_payload_max_length(0);
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"}});
  // The library's default (SO_REUSEPORT) would share the port with another listener.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        const std::string objection = objectionTo(request);
        if (objection.empty()) return httplib::Server::HandlerResponse::Unhandled;
        fill(response, httpError(request.method == "GET" ? 403 : 405, objection));
        return httplib::Server::HandlerResponse::Handled;
      });
  server.set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (response.body.empty()) fill(response, httpError(response.status, "no such page"));
  });
}

void HttpServer::Parts::answer(const std::string& path, const HttpHandler& handler) {
  server.Get(path, [handler](const httplib::Request& request, httplib::Response& response) {
    HttpQuery query;
    for (const auto& [name, value] : request.params) query.emplace(name, value);
    fill(response, answerOf(handler, query));
  });
}

void HttpServer::Parts::bind(const char* option) {
  const std::string asked = address.text();
  errno = 0;
  if (address.port == 0)
    address.port = server.bind_to_any_port(address.host);
  else if (!server.bind_to_port(address.host, address.port))
    address.port = -1;
  if (address.port > 0) return;
  throw failure("{} {}: cannot listen: {}: give another address or port", option, asked,
                errno == 0 ? "the address does not belong to this machine" : errnoText());
}

HttpServer::HttpServer(const HttpAddress& address,
                       const std::map<std::string, HttpHandler>& handlers, const char* option)
    : parts_(std::make_unique<Parts>()) {
  parts_->address = address;
  parts_->limit();
  for (const auto& [path, handler] : handlers) parts_->answer(path, handler);
  parts_->bind(option);
  parts_->listener = quietThread([parts = parts_.get()] {
    parts->server.listen_after_bind();
    parts->ended = true;
  });
  // Wait until the server runs, because stop() does nothing before that.
  while (!parts_->server.is_running() && !parts_->ended)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

HttpServer::~HttpServer() {
  parts_->server.stop();
  parts_->listener.join();
}

const HttpAddress& HttpServer::address() const { return parts_->address; }

}  // namespace palpate
