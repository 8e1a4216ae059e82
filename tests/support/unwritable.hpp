#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "tests/support/temporary_directory.hpp"

namespace palpate::test {

/// Returns the result of `reads` in a process that may not write to `folder`, a folder in
/// `directory`. If the test runs as root, that process runs as the user nobody, who then owns both
/// folders. Returns nullopt if that user cannot reach them.
template <class Reads>
std::optional<bool> readsUnwritable(const std::filesystem::path& folder,
                                    const TemporaryDirectory& directory, Reads reads) {
  constexpr uid_t nobody = 65534;
  constexpr int read = 0, unread = 1, unreachable = 2;
  using std::filesystem::perms;
  if (geteuid() == 0) {
    std::vector<std::filesystem::path> all = {directory.path(), folder};
    for (const auto& entry : std::filesystem::directory_iterator(folder)) all.push_back(entry);
    for (const std::filesystem::path& path : all)
      if (chown(path.c_str(), nobody, nobody) != 0) throw failure("{}: chown", path.string());
  }
  std::filesystem::permissions(folder, perms::owner_read | perms::owner_exec);
  const pid_t child = fork();
  if (child == 0) {
    try {
      if (geteuid() == 0 && setuid(nobody) != 0) _exit(unread);
      if (access(std::filesystem::absolute(folder).c_str(), R_OK) != 0) _exit(unreachable);
      _exit(reads() ? read : unread);
    } catch (const std::exception& error) {
      std::fputs(error.what(), stderr);
      _exit(unread);
    }
  }
  int status = 0;
  const bool ended = waitpid(child, &status, 0) == child && WIFEXITED(status);
  std::filesystem::permissions(folder, perms::owner_all);
  if (ended && WEXITSTATUS(status) == unreachable) return std::nullopt;
  return ended && WEXITSTATUS(status) == read;
}

}  // namespace palpate::test
