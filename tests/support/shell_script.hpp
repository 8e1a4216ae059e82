#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

/// Programs that stand in the place of others.
namespace palpate::test {

/// Writes an executable program of these lines.
inline void writeScript(const std::filesystem::path& file, const std::string& lines) {
  std::ofstream(file) << "#!/bin/sh\n" << lines << '\n';
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

/// As long as it is there, programs are looked for in a folder first, or there alone.
class FirstInPath {
 public:
  explicit FirstInPath(const std::filesystem::path& folder, bool alone = false) {
    setenv("PATH", alone ? folder.c_str() : (folder.string() + ":" + before).c_str(), 1);
  }
  ~FirstInPath() { setenv("PATH", before.c_str(), 1); }
  FirstInPath(const FirstInPath&) = delete;
  FirstInPath& operator=(const FirstInPath&) = delete;

  const std::string before = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "/usr/bin:/bin";
};

}  // namespace palpate::test
