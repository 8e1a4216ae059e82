#pragma once

#include <optional>
#include <string>

#include "common/keys/key_options.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Command-line options that name a scheduler or a state directory, and the keys to use.
struct Asked {
  std::string where = default_endpoint;
  KeyOptions keys;

  /// Declares WHERE, --keys and --insecure.
  void addTo(CLI::App& app);
};

/// Thrown when a process holds the state directory but does not listen yet: it is still reading the
/// recorded results.
class NotListening : public Error {
 public:
  NotListening(const std::string& directory, const std::string& process);
};

/// Resolves `asked.where`. Returns a tcp:// or ipc:// endpoint unchanged. For a state directory,
/// returns the address and keys that its scheduler announced, or none if no scheduler runs. Throws
/// NotListening if that scheduler does not listen yet, and Error (bad input) if `where` is neither
/// an endpoint nor a directory.
std::optional<StateDirectory::Address> schedulerOf(const Asked& asked);

// statusAt() and order() wait 5 s for each answer. They throw Error if no answer comes or if the
// scheduler refuses the request. They also throw if a scheduler of another build now answers at the
// endpoint that the state directory names.

/// Returns the status of the build: from its scheduler, or, if none runs, from the state directory
/// ("complete" or "stopped").
wire::Status statusAt(const Asked& asked);
/// Sends an order to the scheduler and returns its reply, which is of kind `answer`; none if no
/// scheduler runs there.
std::optional<wire::Message> order(const Asked& asked, const wire::Message& what,
                                   wire::Message::BodyCase answer);

}  // namespace palpate
