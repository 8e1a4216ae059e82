#include "common/keys/key_options.hpp"

#include <CLI/CLI.hpp>

namespace palpate {

void KeyOptions::addTo(CLI::App& app, const char* means) {
  auto* const keys =
      app.add_option("--keys", folder, "Folder with keys [$PALPATE_KEYS, ~/.config/palpate/keys]")
          ->type_name("FOLDER");
  app.add_flag("--insecure", insecure, means)->excludes(keys);
}

std::optional<KeyFolder> KeyOptions::keys() const {
  return insecure ? std::nullopt : std::optional(chosenKeyFolder(folder));
}

}  // namespace palpate
