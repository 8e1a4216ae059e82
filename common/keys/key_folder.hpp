#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "common/keys/key_pair.hpp"

namespace palpate {

/// Permissions of a key's holder, as a sum of bits.
enum class Roles : std::uint8_t {
  none = 0,
  worker = 1,    ///< receives work and delivers results
  observer = 2,  ///< reads the status
  /// May stop a build, retry transitions, and use a haptic device, which exerts forces on a
  /// person's hand. Includes observer.
  system_operator = 4 | observer,
  all = worker | system_operator
};
constexpr Roles operator|(Roles a, Roles b) {
  return static_cast<Roles>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// Returns whether `held` includes all of `wanted`.
constexpr bool include(Roles held, Roles wanted) { return (held | wanted) == held; }

/// Convert text such as "worker,operator" to roles, and roles to text. Error (bad input) that lists
/// the valid words if a word is unknown.
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
///   own.key   this user's secret key, 64 hexadecimal digits, for servers and clients
///   allowed   keys that servers of this user admit: KEY ROLES NAME, one per line
///   servers   keys of the servers that clients of this user connect to: KEY ENDPOINT
///
/// # begins a comment. Folder and files must belong to this user (or root) and be inaccessible to
/// others (modes 0700 and 0600). Otherwise, or if their content is invalid, an Error (bad input)
/// gives the remedy. Each change replaces a whole file, and changes by several processes are made
/// one after the other. Nothing is cached in memory. Any thread may read.
class KeyFolder {
 public:
  /// Does not access the folder.
  explicit KeyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path allowedFile() const { return folder_ / "allowed"; }

  bool hasOwn() const;
  KeyPair own() const;
  /// Returns this user's key. If there is none, makes it, and the folder if necessary. Two
  /// processes that do this at the same time get the same key.
  KeyPair ownOrNew() const;
  /// Replaces this user's key by a new one.
  KeyPair replaceOwn() const;

  /// Returns the admitted keys in the order of the file, without this user's own.
  std::vector<AllowedKey> allowed() const;
  /// Adds an entry to the admitted keys; an existing entry for the same key is replaced. Error (bad
  /// input) for a name with control characters or #.
  void allow(const AllowedKey& key) const;
  /// Removes the admitted keys with this name, or the one with these hexadecimal digits. Returns
  /// false if there is no such key.
  bool withdraw(const std::string& name_or_key) const;

  /// Returns the key of the server at `endpoint`: from the line for this endpoint, else from the
  /// line for "*", else this user's key. If all machines of a user share this folder, servers and
  /// clients have the same key, and no list is needed.
  PublicKey serverAt(const std::string& endpoint) const;
  /// Sets the key of the server at `endpoint`, which may be "*".
  void trust(const PublicKey& key, const std::string& endpoint) const;
  /// Returns the entries of the file `servers` as (endpoint, key).
  std::vector<std::pair<std::string, PublicKey>> servers() const;

 private:
  std::filesystem::path folder_;
};

/// The keys that a running server admits: its own key with every role, and the list in its key
/// folder. rolesOf() reads the list again if the last reading is at least one second old, so that
/// keys can be added and withdrawn during a build. Any thread.
class Admission {
 public:
  /// Makes this user's key if there is none. Error (bad input) if the list cannot be read. If the
  /// list becomes unreadable later, a warning is logged and the last list that was read stays in
  /// force.
  explicit Admission(KeyFolder folder);

  /// Returns the roles of a key; Roles::none if the key is not admitted.
  Roles rolesOf(const PublicKey& key);

 private:
  using Clock = std::chrono::steady_clock;

  void read();

  const KeyFolder folder_;
  const PublicKey own_;
  std::mutex mutex_;  ///< guards the members below
  std::map<PublicKey, Roles> roles_;
  Clock::time_point read_at_;
  std::string trouble_;  ///< why the list could not be read last time
};

/// Returns the folder given by `option` (--keys), else $PALPATE_KEYS, $XDG_CONFIG_HOME/palpate/keys
/// or $HOME/.config/palpate/keys. Error (bad input) if none of them is set.
KeyFolder chosenKeyFolder(const std::string& option);

}  // namespace palpate
