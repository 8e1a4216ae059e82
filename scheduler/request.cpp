#include "scheduler/request.hpp"

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

wire::Message ask(const std::string& endpoint, const wire::Message& question) {
  constexpr std::chrono::duration<double> patience{5};
  zmq::context_t context;
  zmq::socket_t socket = makeDealer(context);
  // The question waits until there is a connection.
  socket.set(zmq::sockopt::immediate, false);
  connectDealer(socket, endpoint);
  if (sendMessage(socket, "", question) != Sent::yes) throw failure("{}: cannot send", endpoint);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (auto answer = receiveMessage(socket, false)) return std::move(answer->message);
    if (!waitForMessages(socket, std::chrono::milliseconds(100)))
      throw Error(ExitCode::interrupted, "interrupted");
  }
  throw failure("{}: no answer within {:.1f} s: is a Palpate scheduler running there?", endpoint,
                patience.count());
}

std::string endpointOf(const std::string& where) {
  if (where.starts_with("tcp://") || where.starts_with("ipc://")) return where;
  if (!std::filesystem::is_directory(where))
    throw badInput("\"{}\" is neither tcp://HOST:PORT nor a state directory", where);
  return StateDirectory::liveEndpoint(where).value_or("");
}

}  // namespace palpate
