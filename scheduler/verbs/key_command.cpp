
#include "common/base/required_option.hpp"
#include "common/keys/key_folder.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate key`: manages this user's keys, and the keys that servers allow.

namespace palpate {
namespace {

struct KeyOrder {
  std::string folder;
  bool replace = false;
  std::string key, roles, name;
  std::string endpoint = "*";
  void (*run)(const KeyOrder&, const KeyFolder&) = nullptr;
};

PublicKey writtenKey(const std::string& hex) {
  if (const auto key = PublicKey::fromHex(hex)) return *key;
  throw badInput("\"{}\" is not a key of 64 hexadecimal digits, as palpate key show prints it",
                 hex);
}

void makeNew(const KeyOrder& order, const KeyFolder& folder) {
  if (folder.hasOwn() && !order.replace)
    throw badInput("{}: a key exists already; --replace creates another, which no server knows yet",
                   folder.path().string());
  const KeyPair own = order.replace ? folder.replaceOwn() : folder.ownOrNew();
  fmt::print("{}\n", own.open().hex());
}

void show(const KeyOrder&, const KeyFolder& folder) {
  fmt::print("{} your key, in {}\n", folder.own().open().hex(), folder.path().string());
  for (const AllowedKey& key : folder.allowed())
    fmt::print("{} allowed as {}: {}\n", key.key.hex(), wordsOf(key.roles), key.name);
  for (const auto& [endpoint, key] : folder.servers())
    fmt::print("{} key of the server at {}\n", key.hex(), endpoint);
}

void allow(const KeyOrder& order, const KeyFolder& folder) {
  folder.allow({writtenKey(order.key), rolesOf(order.roles), order.name});
  fmt::print("servers that use the keys in {} now allow this key, including running servers\n",
             folder.path().string());
}

void withdraw(const KeyOrder& order, const KeyFolder& folder) {
  if (!folder.withdraw(order.key))
    throw badInput("{}: no key \"{}\"; palpate key show lists the keys",
                   folder.allowedFile().string(), order.key);
  fmt::print("no longer allowed; running servers disconnect its holder within a second\n");
}

void trust(const KeyOrder& order, const KeyFolder& folder) {
  if (order.endpoint != "*") checkEndpoint(order.endpoint);
  folder.trust(writtenKey(order.key), order.endpoint);
  fmt::print("trusted as the key of {}\n",
             order.endpoint == "*" ? "every server without a key of its own" : order.endpoint);
}

using Order = std::shared_ptr<KeyOrder>;

/// Declares `palpate key NAME`.
CLI::App& declare(CLI::App& app, const Order& order, const char* name, const char* summary,
                  void (*run)(const KeyOrder&, const KeyFolder&)) {
  CLI::App& verb = *app.add_subcommand(name, summary);
  verb.callback([order, run] { order->run = run; });
  verb.add_option("--keys", order->folder,
                  "Folder with keys [$PALPATE_KEYS, ~/.config/palpate/keys]")
      ->type_name("FOLDER");
  return verb;
}

std::function<ExitCode()> prepareKey(CLI::App& app) {
  const auto order = std::make_shared<KeyOrder>();
  declare(app, order, "new", "Create your key pair and print the public key", makeNew)
      .add_flag("--replace", order->replace, "Replace the existing key pair");
  declare(app, order, "show", "Print your public key, the allowed keys and the known servers",
          show);
  CLI::App& allowed = declare(app, order, "allow", "Allow the holder of a key to connect", allow);
  addRequired(allowed, "KEY", order->key, "Public key of the holder, from palpate key show");
  addRequired(allowed, "ROLES", order->roles,
              "worker, observer, operator, or several (worker,observer)");
  allowed.add_option("NAME", order->name, "Readable name of the key");
  declare(app, order, "withdraw", "Withdraw the permission of a key", withdraw)
      .add_option("KEY", order->key, "Digits or name of the key")
      ->required();
  CLI::App& trusted = declare(app, order, "trust", "Record the public key of a server", trust);
  addRequired(trusted, "KEY", order->key, "Public key of the server, from palpate key show");
  trusted.add_option("--at", order->endpoint, "Endpoint of the server [every server]");
  app.require_subcommand(1);
  app.footer(
      "Servers and clients that share this folder accept each other without further setup.\n"
      "docs/security.md describes the setup of other machines.");
  return [order] {
    order->run(*order, chosenKeyFolder(order->folder));
    return ExitCode::done;
  };
}

}  // namespace

const Verb key_verb = {"key", "Make a key; allow other machines and people, or withdraw their keys",
                       prepareKey};

}  // namespace palpate
