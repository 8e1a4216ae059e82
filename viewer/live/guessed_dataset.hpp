#pragma once

#include <filesystem>

#include "common/problem/problem.hpp"

namespace palpate {

/// A dataset of guesses for a scene that nobody has computed: a spring at every site of a finger,
/// about as stiff as the softest material. A hand feels it for the first hundredths of a second of
/// a contact, until a follower has answered, and where the follower does not keep up (LiveTouch
/// with `guessed`). The file is removed with this object.
class GuessedDataset {
 public:
  /// Error (bad input) if no finger touches the scene. Error if the file cannot be written, in the
  /// directory for temporary files.
  explicit GuessedDataset(Problem problem);
  ~GuessedDataset();
  GuessedDataset(const GuessedDataset&) = delete;
  GuessedDataset& operator=(const GuessedDataset&) = delete;

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path folder_, file_;
};

/// Makes a directory for temporary files that only this user can open. Error if that fails.
std::filesystem::path makePrivateFolder();

}  // namespace palpate
