#pragma once

#include "common/base/scratch_folder.hpp"
#include "common/problem/problem.hpp"

namespace palpate {

/// A dataset without any solution, for a scene that has no dataset yet. Its lattices are as coarse
/// as possible. HapticModelOptions::guess lets a hand touch it. The destructor removes the file.
class UnsolvedDataset {
 public:
  /// Error (bad input) if a tool of the scene is not a finger, or if its fingers have several
  /// radii. Error if the file cannot be written
  /// in the directory for temporary files.
  explicit UnsolvedDataset(Problem problem);

  const std::filesystem::path& file() const { return file_; }

 private:
  ScratchFolder folder_;
  std::filesystem::path file_;
};

}  // namespace palpate
