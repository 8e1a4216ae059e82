#pragma once

#include <stdlib.h>

#include <filesystem>

#include "common/base/error.hpp"

namespace palpate {

/// A folder for what foreign programs read and write, gone with the object.
class ScratchFolder {
 public:
  /// Error when the system gives none.
  ScratchFolder() {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error)
      throw failure("no folder to work in: {}; set TMPDIR to one that is there", error.message());
    std::string name = (parent / "palpate-mesh-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw failure("{}: cannot make a folder to work in: {}; set TMPDIR to another one", name,
                    errnoText());
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;  // what is left there harms nobody
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
