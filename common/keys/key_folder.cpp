#include "common/keys/key_folder.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <functional>

#include "common/base/assertion.hpp"
#include "common/base/text_lines.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

/// The words of roles. `operator` comes before `observer`, because it includes that role.
constexpr std::array<std::pair<std::string_view, Roles>, 3> role_words = {
    {{"worker", Roles::worker},
     {"operator", Roles::system_operator},
     {"observer", Roles::observer}}};

constexpr std::chrono::seconds read_again_after{1};

/// Returns true if only this user and root can read or change the path, and false if it does not
/// exist. Error if anyone else can.
bool isPrivate(const std::filesystem::path& path, mode_t wanted) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return false;
    throw failure("{}: cannot read its permissions: {}", path.string(), errnoText());
  }
  if (info.st_uid != geteuid() && info.st_uid != 0)
    throw badInput("{}: belongs to another user, who could change the keys; use your own folder",
                   path.string());
  if ((info.st_mode & 077) != 0)
    throw badInput("{}: other users may read or change it (mode {:04o}); run: chmod {:04o} '{}'",
                   path.string(), info.st_mode & 07777, wanted, path.string());
  return true;
}

/// Returns the lines of a file of the key folder, without comments; nullopt if there is no file.
std::optional<TextLines> privateLines(const std::filesystem::path& file) {
  if (!isPrivate(file.parent_path(), 0700) || !isPrivate(file, 0600)) return std::nullopt;
  std::string text = readText(file, "key file");
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at)) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    text.erase(at, end - at);
  }
  return TextLines(std::move(text), file.string());
}

PublicKey takeKey(TextLines& lines) {
  const std::string_view word = lines.takeWord();
  if (const auto key = PublicKey::fromHex(word)) return *key;
  throw lines.wrong("\"{}\" is not a key (64 hexadecimal digits, as printed by palpate key show)",
                    word);
}

void makePrivateFolder(const std::filesystem::path& folder) {
  std::error_code error;
  if (folder.has_parent_path()) std::filesystem::create_directories(folder.parent_path(), error);
  // Create the folder with its final mode. If the mode were set afterwards, another program could
  // open the folder in between.
  if (!error && mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    error = {errno, std::generic_category()};
  if (error)
    throw failure("{}: cannot make this folder for keys: {}; give another one with --keys",
                  folder.string(), error.message());
  isPrivate(folder, 0700);
}

/// Replaces the content of `file` by the result of `text`, which may read the old content: no other
/// process changes the file in the meantime. The file is never accessible to other users.
void writePrivate(const std::filesystem::path& file, const std::function<std::string()>& text) {
  makePrivateFolder(file.parent_path());
  replaceFile(file, text, "keys", 0600);
}

std::string lineOf(const KeyPair& own) { return own.secret().hex() + '\n'; }

std::filesystem::path ownFile(const std::filesystem::path& folder) { return folder / "own.key"; }

/// Reads the list of admitted keys, applies `change` and writes the list.
void changeAllowed(const KeyFolder& folder,
                   const std::function<void(std::vector<AllowedKey>& keys)>& change) {
  writePrivate(folder.allowedFile(), [&] {
    std::vector<AllowedKey> keys = folder.allowed();
    change(keys);
    std::string text =
        "# Keys that servers admit: key, roles, name. Change with palpate key allow and "
        "withdraw.\n";
    for (const AllowedKey& key : keys)
      text += fmt::format("{} {} {}\n", key.key.hex(), wordsOf(key.roles), key.name);
    return text;
  });
}

}  // namespace

Roles rolesOf(std::string_view words) {
  Roles roles = Roles::none;
  for (std::size_t at = 0, end = 0; end != std::string_view::npos; at = end + 1) {
    end = words.find(',', at);
    const std::string_view word = words.substr(at, end - at);
    const auto* const known =
        std::ranges::find(role_words, word, [](const auto& entry) { return entry.first; });
    if (known == role_words.end())
      throw badInput(
          "\"{}\" is not a role; write worker, observer, operator, or several separated by commas",
          word);
    roles = roles | known->second;
  }
  return roles;
}

std::string wordsOf(Roles roles) {
  std::string words;
  Roles written = Roles::none;
  for (const auto& [word, role] : role_words) {
    if (!include(roles, role) || include(written, role)) continue;
    words += fmt::format("{}{}", words.empty() ? "" : ",", word);
    written = written | role;
  }
  return words;
}

bool KeyFolder::hasOwn() const { return std::filesystem::exists(ownFile(folder_)); }

KeyPair KeyFolder::own() const {
  auto lines = privateLines(ownFile(folder_));
  if (!lines)
    throw badInput("{}: you have no key yet; make one with: palpate key new",
                   ownFile(folder_).string());
  const auto secret = lines->advance() ? Bytes32::fromHex(lines->takeWord()) : std::nullopt;
  if (!secret || lines->advance())
    throw badInput(
        "{}: is not a key (64 hexadecimal digits); make one with: palpate key new --replace",
        ownFile(folder_).string());
  return KeyPair(*secret);
}

KeyPair KeyFolder::ownOrNew() const {
  if (hasOwn()) return own();
  // Another process may make a key at the same time. link() keeps the first key, even on file
  // systems without locks.
  const std::filesystem::path aside = folder_ / fmt::format("own.key.{}", getpid());
  writePrivate(aside, [] { return lineOf(KeyPair::make()); });
  const bool first = link(aside.c_str(), ownFile(folder_).c_str()) == 0;
  const int reason = errno;
  std::error_code ignored;
  std::filesystem::remove(aside, ignored);
  if (!first && reason != EEXIST)
    throw failure("{}: cannot create it: {}", ownFile(folder_).string(), std::strerror(reason));
  syncFolder(folder_);
  return own();
}

KeyPair KeyFolder::replaceOwn() const {
  writePrivate(ownFile(folder_), [] { return lineOf(KeyPair::make()); });
  return own();
}

std::vector<AllowedKey> KeyFolder::allowed() const {
  std::vector<AllowedKey> keys;
  auto lines = privateLines(allowedFile());
  while (lines && lines->advance()) {
    AllowedKey entry;
    entry.key = takeKey(*lines);
    const std::string_view words = lines->takeWord();
    try {
      entry.roles = rolesOf(words);
    } catch (const Error& error) {
      throw lines->wrong("{}", error.what());
    }
    entry.name = lines->rest();
    keys.push_back(std::move(entry));
  }
  return keys;
}

void KeyFolder::allow(const AllowedKey& key) const {
  PALPATE_ASSERT(key.roles != Roles::none, "an allowed key must have a role");
  // After a line break the rest of a name would be read as an entry and could admit another key.
  const auto breaks = [](char c) {
    return std::iscntrl(static_cast<unsigned char>(c)) || c == '#';
  };
  if (std::ranges::any_of(key.name, breaks))
    throw badInput("\"{}\" is not a name; it must not have a line break, control character or #",
                   key.name);
  changeAllowed(*this, [&](std::vector<AllowedKey>& keys) {
    std::erase_if(keys, [&](const AllowedKey& other) { return other.key == key.key; });
    keys.push_back(key);
  });
}

bool KeyFolder::withdraw(const std::string& name_or_key) const {
  if (name_or_key.empty()) return false;  // an empty name must not match keys without a name
  const auto is_meant = [&](const AllowedKey& key) {
    return key.key.hex() == name_or_key || key.name == name_or_key;
  };
  if (std::ranges::none_of(allowed(), is_meant)) return false;
  changeAllowed(*this, [&](std::vector<AllowedKey>& keys) { std::erase_if(keys, is_meant); });
  return true;
}

std::vector<std::pair<std::string, PublicKey>> KeyFolder::servers() const {
  std::vector<std::pair<std::string, PublicKey>> servers;
  auto lines = privateLines(folder_ / "servers");
  while (lines && lines->advance()) {
    const PublicKey key = takeKey(*lines);
    servers.emplace_back(lines->takeWord(), key);
    if (servers.back().first.empty())
      throw lines->wrong("the endpoint of the server is missing; * stands for all");
    lines->expectEndOfLine();
  }
  return servers;
}

PublicKey KeyFolder::serverAt(const std::string& endpoint) const {
  const auto all = servers();
  for (const std::string& wanted : {endpoint, std::string("*")})
    for (const auto& [where, key] : all)
      if (where == wanted) return key;
  return own().open();
}

void KeyFolder::trust(const PublicKey& key, const std::string& endpoint) const {
  writePrivate(folder_ / "servers", [&] {
    auto all = servers();
    std::erase_if(all, [&](const auto& entry) { return entry.first == endpoint; });
    all.emplace_back(endpoint, key);
    std::string text =
        "# Keys of servers: key, endpoint (* for all others). Change with palpate key trust.\n";
    for (const auto& [where, of] : all) text += fmt::format("{} {}\n", of.hex(), where);
    return text;
  });
}

Admission::Admission(KeyFolder folder)
    : folder_(std::move(folder)), own_(folder_.ownOrNew().open()) {
  read();
}

void Admission::read() {
  read_at_ = Clock::now();
  std::map<PublicKey, Roles> roles;
  for (const AllowedKey& key : folder_.allowed()) roles[key.key] = key.roles;
  roles[own_] = Roles::all;
  roles_ = std::move(roles);
}

Roles Admission::rolesOf(const PublicKey& key) {
  const std::lock_guard lock(mutex_);
  if (Clock::now() - read_at_ >= read_again_after) try {
      read();
      trouble_.clear();
    } catch (const Error& error) {
      if (trouble_ != error.what())
        spdlog::warn("{}; the keys admitted before stay admitted", error.what());
      trouble_ = error.what();
    }
  PALPATE_ASSERT(roles_.contains(own_), "the own key must be admitted");
  const auto found = roles_.find(key);
  return found == roles_.end() ? Roles::none : found->second;
}

KeyFolder chosenKeyFolder(const std::string& option) {
  if (!option.empty()) return KeyFolder(option);
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto folder = variable("PALPATE_KEYS"); !folder.empty()) return KeyFolder(folder);
  if (const auto config = variable("XDG_CONFIG_HOME"); config.is_absolute())
    return KeyFolder(config / "palpate" / "keys");
  if (const auto home = variable("HOME"); home.is_absolute())
    return KeyFolder(home / ".config" / "palpate" / "keys");
  throw badInput(
      "there is no folder for keys (HOME is not set); give --keys FOLDER or set PALPATE_KEYS");
}

}  // namespace palpate
