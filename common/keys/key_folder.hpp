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

/// What the holder of a key may do: a sum of bits.
enum class Roles : std::uint8_t {
  none = 0,
  worker = 1,    ///< takes work and delivers results
  observer = 2,  ///< reads the status
  /// Stops a build, tries again, takes a haptic device and pushes the hand that holds it. Is an
  /// observer too.
  system_operator = 4 | observer,
  all = worker | system_operator
};
constexpr Roles operator|(Roles a, Roles b) {
  return static_cast<Roles>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// Whether `wanted` is among the roles that somebody has.
constexpr bool include(Roles held, Roles wanted) { return (held | wanted) == held; }

/// "worker,operator" and back. Error (bad input) for a word that is no role, which lists them.
Roles rolesOf(std::string_view words);
std::string wordsOf(Roles roles);

/// A key that a server lets in.
struct AllowedKey {
  PublicKey key;
  Roles roles = Roles::none;
  std::string name;  ///< for people; may be empty
};

/// The folder with the keys of one user (docs/security.md):
///
///   own.key   the own secret, 64 hexadecimal digits; a server's and a client's alike
///   allowed   whom servers of this user let in: KEY ROLES NAME, a line each
///   servers   which keys the servers have that this user's clients talk to: KEY ENDPOINT
///
/// # begins a comment. Folder and files must belong to this user (or root) and be closed to others
/// (0700, 0600); Error (bad input), which says how to mend it, when they are not, or make no sense.
/// Changes replace a file whole, one after the other, whichever processes make them. Any thread may
/// read; nothing is kept in memory.
class KeyFolder {
 public:
  /// Touches nothing.
  explicit KeyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path allowedFile() const { return folder_ / "allowed"; }

  bool hasOwn() const;
  KeyPair own() const;
  /// The own key, made before when there is none, with the folder. Two that make one at the same
  /// time get the same.
  KeyPair ownOrNew() const;
  /// A new one in the place of the old.
  KeyPair replaceOwn() const;

  /// In the order of the file; the own key is not among them.
  std::vector<AllowedKey> allowed() const;
  /// In the place of what the same key had before. Error (bad input) for a name that would be more
  /// than the rest of one line.
  void allow(const AllowedKey& key) const;
  /// By its name or its digits. False when there is no such.
  bool withdraw(const std::string& name_or_key) const;

  /// The key of the server at `endpoint`: of its line, else of the line for "*"; else the own key:
  /// a user whose machines share this folder needs no list.
  PublicKey serverAt(const std::string& endpoint) const;
  /// `endpoint` may be "*".
  void trust(const PublicKey& key, const std::string& endpoint) const;
  /// Lines of `servers`: endpoint and key.
  std::vector<std::pair<std::string, PublicKey>> servers() const;

 private:
  std::filesystem::path folder_;
};

/// Whom a running server lets in: the own key with every role, and the list of its folder, which is
/// read again every second, so that keys are added and withdrawn while a build runs. Any thread.
class Admission {
 public:
  /// Makes the own key when there is none. Error (bad input) when the list cannot be read. Later a
  /// list that cannot be read is told of, and the last good one stays.
  explicit Admission(KeyFolder folder);

  /// None: the key is not let in.
  Roles rolesOf(const PublicKey& key);

 private:
  using Clock = std::chrono::steady_clock;

  void read();

  const KeyFolder folder_;
  const PublicKey own_;
  std::mutex mutex_;  ///< guards what is below
  std::map<PublicKey, Roles> roles_;
  Clock::time_point read_at_;
  std::string trouble_;  ///< why the list could not be read last
};

/// The folder that `option` (--keys) names; else $PALPATE_KEYS, $XDG_CONFIG_HOME/palpate/keys or
/// $HOME/.config/palpate/keys. Error (bad input) when nothing of that is known.
KeyFolder chosenKeyFolder(const std::string& option);

}  // namespace palpate
