#pragma once

#include <optional>
#include <string>

#include "common/keys/key_options.hpp"
#include "common/wire/wire.hpp"

namespace palpate {

/// Who is asked: a scheduler, or a state directory, and with which keys.
struct Asked {
  std::string where = default_endpoint;
  KeyOptions keys;

  /// WHERE, --keys and --insecure.
  void addTo(CLI::App& app);
};

/// Where a scheduler listens, and the keys to ask it with; nothing: it asks for none.
struct Reachable {
  std::string endpoint;
  std::optional<KeyFolder> keys;
};

/// A process works in a state directory and cannot be asked: it is starting, and reads or seals
/// what is recorded.
class NotListening : public Error {
 public:
  NotListening(const std::string& directory, const std::string& process);
};

/// The scheduler that is meant: that at tcp:// or ipc://, else the one which now works in the state
/// directory, with the keys that it says; nothing when none does. NotListening when it does not
/// listen yet. Error (bad input) when it is neither.
std::optional<Reachable> schedulerOf(const Asked& asked);

/// Asks a scheduler one thing and waits for the answer. Error when none comes within 5 s, it does
/// not let this key ask that, or the endpoint makes no sense.
wire::Message ask(const Reachable& scheduler, const wire::Message& question);
/// The status of the scheduler that answers. Error when `where` is a state directory and that
/// scheduler is one of another build: somebody took the endpoint over.
wire::Status askStatus(const Reachable& scheduler, const std::string& where);
/// Tells the scheduler what to do, if it is the one of the place that was named. Its answer.
wire::Message order(const Asked& asked, const Reachable& scheduler, const wire::Message& what);

}  // namespace palpate
