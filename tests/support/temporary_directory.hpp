#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "common/base/error.hpp"

namespace palpate::test {

/// A new directory that is removed with its contents when this object is destroyed.
class TemporaryDirectory {
 public:
  explicit TemporaryDirectory(
      const std::filesystem::path& where = std::filesystem::temp_directory_path()) {
    std::string name = (where / "palpate-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw failure("cannot make a directory like {}", name);
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate::test
