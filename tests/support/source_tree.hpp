#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace palpate::test {

/// The sources on disk as in a clone, without build outputs.
struct SourceTree {
  std::filesystem::path root = PALPATE_SOURCE_DIR;
  std::vector<std::string> files;  ///< relative to the root, sorted
  std::set<std::string> folders;   ///< every folder that is not empty, including the root ("")

  SourceTree() {
    namespace fs = std::filesystem;
    for (auto entry = fs::recursive_directory_iterator(root);
         entry != fs::recursive_directory_iterator(); ++entry) {
      const std::string name = entry->path().filename();
      const bool made =
          (entry.depth() == 0 && name == "build") || name.ends_with("__") || name.starts_with(".");
      if (entry->is_directory() && made) entry.disable_recursion_pending();
      if (entry->is_regular_file()) files.push_back(fs::relative(entry->path(), root));
    }
    std::sort(files.begin(), files.end());
    for (const std::string& file : files)
      for (fs::path folder = fs::path(file).parent_path();; folder = folder.parent_path()) {
        folders.insert(folder);
        if (folder.empty()) break;
      }
  }

  bool holds(const std::string& path) const {
    return folders.contains(path) || std::binary_search(files.begin(), files.end(), path);
  }

  std::string text(const std::string& file) const {
    std::ifstream in(root / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::vector<std::string> lines(const std::string& file) const {
    std::vector<std::string> result;
    std::istringstream in(text(file));
    for (std::string line; std::getline(in, line);) result.push_back(line);
    return result;
  }
};

inline const SourceTree& sourceTree() {
  static const SourceTree tree;
  return tree;
}

/// "a/b" for "a/b/c.hpp"; "" for a file in the root.
inline std::string folderOf(const std::string& file) {
  return std::filesystem::path(file).parent_path();
}

/// "worker" for "worker/solver".
inline std::string topOf(const std::string& path) { return path.substr(0, path.find('/')); }

inline bool hasExtension(const std::string& file, const std::set<std::string>& extensions) {
  return extensions.contains(std::filesystem::path(file).extension());
}

inline bool isCode(const std::string& file) {
  return hasExtension(file, {".cpp", ".hpp", ".c", ".h"});
}

}  // namespace palpate::test
