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

// Both wait 5 s for an answer. Error when none comes, the scheduler does not let this key ask that,
// or one of another build took over the endpoint that the state directory names.

/// How far the build there is: as its scheduler says, or "complete" or "stopped" as a directory
/// says in which none works.
wire::Status statusAt(const Asked& asked);
/// Tells the scheduler what to do. Its answer, of this kind; nothing when none works there.
std::optional<wire::Message> order(const Asked& asked, const wire::Message& what,
                                   wire::Message::BodyCase answer);

}  // namespace palpate
