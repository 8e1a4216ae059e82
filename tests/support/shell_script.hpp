#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

/// Scripts that stand in for other programs.
namespace palpate::test {

/// Writes these lines as an executable program.
inline void writeScript(const std::filesystem::path& file, const std::string& lines) {
  std::ofstream(file) << "#!/bin/sh\n" << lines << '\n';
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

/// While this object exists, programs are looked up in a folder first, or only there if `alone`.
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
