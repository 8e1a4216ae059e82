#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace palpate {

/// Line numbers of a table and its keys in the scene file, for errors that only the mesh reveals.
/// Any two compare equal, because the lines do not change the meaning of a scene.
struct KeyLines {
  int table = 0;  ///< from 1; 0 if unknown
  std::vector<std::pair<std::string, int>> keys = {};

  /// Returns the line of the key, or of the table if the key is absent.
  int of(std::string_view key) const {
    for (const auto& [name, line] : keys)
      if (name == key) return line;
    return table;
  }
  bool operator==(const KeyLines&) const { return true; }
};

/// An error about a line of the scene file. Its catcher adds file and line to the message.
class SceneError : public Error {
 public:
  SceneError(int line, const Error& error) : Error(error), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

/// Makes a badInput() about this line.
template <class... Args>
SceneError badInputAt(int line, fmt::format_string<Args...> format, Args&&... args) {
  return {line, badInput(format, std::forward<Args>(args)...)};
}

/// Returns the result of `work`. An Error that it throws gets this line unless it already has one.
template <class Work>
auto atLine(int line, const Work& work) {
  try {
    return work();
  } catch (const SceneError&) {
    throw;
  } catch (const Error& error) {
    throw SceneError(line, error);
  }
}

}  // namespace palpate
