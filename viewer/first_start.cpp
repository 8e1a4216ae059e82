#include "viewer/first_start.hpp"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

namespace palpate {
namespace {

/// What the environment says where it is an absolute path; the rule of the XDG specification.
std::filesystem::path variable(const char* name) {
  const char* const value = std::getenv(name);
  const std::filesystem::path path = value != nullptr ? value : "";
  return path.is_absolute() ? path : std::filesystem::path();
}

std::filesystem::path stateFolder() {
  if (const auto state = variable("XDG_STATE_HOME"); !state.empty()) return state / "palpate";
  const auto home = variable("HOME");
  return home.empty() ? home : home / ".local/state/palpate";
}

}  // namespace

bool firstStart() {
  const std::filesystem::path folder = stateFolder();
  if (folder.empty()) return false;
  const std::filesystem::path mark = folder / "tutorial-shown";
  std::error_code trouble;
  if (std::filesystem::exists(mark, trouble) || trouble) return false;
  std::filesystem::create_directories(folder, trouble);
  std::ofstream file(mark);
  if (!file.put('\n').flush()) {
    spdlog::debug("{} cannot be written, so no tutorial is shown; --tutorial shows it",
                  mark.string());
    return false;
  }
  return true;
}

}  // namespace palpate
