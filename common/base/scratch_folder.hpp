#pragma once

#include <stdlib.h>

#include <filesystem>

#include "common/base/error.hpp"

namespace palpate {

/// A temporary folder that only this user can open, deleted with the object.
class ScratchFolder {
 public:
  /// Error if the system provides no folder.
  ScratchFolder() {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error)
      throw failure("no temporary folder: {}; set TMPDIR to an existing one", error.message());
    std::string name = (parent / "palpate-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw failure("{}: cannot make a temporary folder: {}; set TMPDIR to another one", name,
                    errnoText());
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;  // a folder that cannot be deleted does no harm
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpate
