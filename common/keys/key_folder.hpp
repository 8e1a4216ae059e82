#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/keys/key_pair.hpp"

namespace palpate {

/// Permissions of a key's holder, as a sum of bits.
enum class Roles : std::uint8_t {
  none = 0,
  worker = 1,    ///< takes work and delivers results
  observer = 2,  ///< reads the status
  /// May stop a build, retry transitions, take a haptic device and push the hand that holds it.
  /// Includes observer.
  system_operator = 4 | observer,
  all = worker | system_operator
};
constexpr Roles operator|(Roles a, Roles b) {
  return static_cast<Roles>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// Returns whether `held` includes all of `wanted`.
constexpr bool include(Roles held, Roles wanted) { return (held | wanted) == held; }

/// Convert "worker,operator" to roles and back. Error (bad input) for an unknown word, with a list
/// of the valid ones.
Roles rolesOf(std::string_view words);
std::string wordsOf(Roles roles);

/// A key that a server admits.
struct AllowedKey {
  PublicKey key;
  Roles roles = Roles::none;
  std::string name;  ///< for display; may be empty
};

/// The folder with the keys of one user (docs/security.md):
///
///   own.key   the own secret, 64 hexadecimal digits, for servers and clients
///   allowed   keys that servers of this user admit: KEY ROLES NAME, one per line
///   servers   keys of the servers that clients of this user connect to: KEY ENDPOINT
///
/// # begins a comment. Folder and files must belong to this user (or root) and be closed to others
/// (0700, 0600). Error (bad input) with a remedy if they are not, or if their content is invalid.
/// Each change replaces a whole file; changes of several processes are serialised. Any thread may
/// read; nothing is cached in memory.
class KeyFolder {
 public:
  /// Does not access the folder.
  explicit KeyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path allowedFile() const { return folder_ / "allowed"; }

  bool hasOwn() const;
  KeyPair own() const;
  /// Returns the own key; makes it and the folder if there is none. Two processes that do so at the
  /// same time get the same key.
  KeyPair ownOrNew() const;
  /// Replaces the own key by a new one.
  KeyPair replaceOwn() const;

  /// In the order of the file, without the own key.
  std::vector<AllowedKey> allowed() const;
  /// Adds a key, replacing an entry of the same key. Error (bad input) for a name that does not fit
  /// on the rest of one line.
  void allow(const AllowedKey& key) const;
  /// Removes keys by name or hexadecimal digits. Returns false if there is no such key.
  bool withdraw(const std::string& name_or_key) const;

  /// Returns the key of the server at `endpoint`: from its line, else from the line for "*", else
  /// the own key. A user whose machines share this folder needs no list.
  PublicKey serverAt(const std::string& endpoint) const;
  /// Sets the key of the server at `endpoint`, which may be "*".
  void trust(const PublicKey& key, const std::string& endpoint) const;
  /// Lines of `servers` as (endpoint, key).
  std::vector<std::pair<std::string, PublicKey>> servers() const;

 private:
  std::filesystem::path folder_;
};

/// The keys that a running server admits: the own key with every role, and the list of its folder.
/// The list is read again every second, so that keys can be added and withdrawn during a build. Any
/// thread.
class Admission {
 public:
  /// Makes the own key if there is none. Error (bad input) if the list cannot be read. If it
  /// becomes unreadable later, a warning is logged and the last good list stays in force.
  explicit Admission(KeyFolder folder);

  /// Returns none if the key is not admitted.
  Roles rolesOf(const PublicKey& key);

 private:
  using Clock = std::chrono::steady_clock;

  void read();

  const KeyFolder folder_;
  const PublicKey own_;
  std::mutex mutex_;  ///< guards the members below
  std::map<PublicKey, Roles> roles_;
  Clock::time_point read_at_;
  std::string trouble_;  ///< reason of the last failure to read the list
};

/// Returns the folder given by `option` (--keys), else $PALPATE_KEYS, $XDG_CONFIG_HOME/palpate/keys
/// or $HOME/.config/palpate/keys. Error (bad input) if none of them is set.
KeyFolder chosenKeyFolder(const std::string& option);

}  // namespace palpate
