#include "scheduler/web/http_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/error.hpp"
#include "common/base/number_in.hpp"

#undef _res  // a macro of <resolv.h>, and a name of Eigen's, which others of this batch include

namespace palpate {
namespace {

/// Behind the scheduler, which may have the only processor.
constexpr int niceness = 10;

/// A thread that sees no signals: they are for the main thread.
std::thread quietThread(std::function<void()> run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread([run = std::move(run)] {
    // Of this thread alone, on Linux. Without it the work is done all the same.
    static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness));
    run();
  });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

/// Connections that were taken: when as many wait as are in work, the next is not taken. One that
/// was is never dropped, since it would stay open. Made by the listener, its threads see no signals
/// either, and are as nice.
class BoundedPool : public httplib::TaskQueue {
 public:
  /// Nothing, or in newer versions of cpp-httplib whether the task was taken.
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

/// Of a name or a number, that of IPv6 without brackets.
bool namesLoopback(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  in_addr number{};
  return name == "localhost" || name == "::1" ||
         (name.starts_with("127.") && inet_pton(AF_INET, name.c_str(), &number) == 1);
}

/// What a request calls the server: "localhost:80", "[::1]". Empty when that is no name.
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
                                                       nlohmann::json::error_handler_t::replace),
          .headers = {}};
}

struct HttpServer::Parts {
  HttpAddress address;
  httplib::Server server;
  std::thread listener;
  std::atomic<bool> ended = false;

  /// Why this request gets no answer; empty when it does.
  std::string objectionTo(const httplib::Request& request) const {
    if (request.method != "GET") return "only GET is answered here";
    if (address.isLoopback() && !namesLoopback(nameIn(request.get_header_value("Host"))))
      return "this is answered to who asks for localhost alone";
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    if (!site.empty() && site != "same-origin" && site != "none")
      return "this is not answered for pages of others";
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
  // The library would share the port with whoever else listens there.
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
    if (response.body.empty()) fill(response, httpError(response.status, "there is nothing here"));
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
  throw failure("{} {}: cannot listen there: {}: give another address or port", option, asked,
                errno == 0 ? "it is none of this machine" : errnoText());
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
  // Before that, stop() would do nothing.
  while (!parts_->server.is_running() && !parts_->ended)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

HttpServer::~HttpServer() {
  parts_->server.stop();
  parts_->listener.join();
}

const HttpAddress& HttpServer::address() const { return parts_->address; }

}  // namespace palpate
