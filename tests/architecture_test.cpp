#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/source_tree.hpp"

// Rules of the architecture. The rules list no names: folders and files are read from the tree, and
// the allowed includes of a folder from the CMakeLists.txt that links it.

namespace palpate {
namespace {

using test::folderOf;
using test::sourceTree;
using test::topOf;

using Names = std::set<std::string>;
using Graph = std::map<std::string, Names>;  ///< the nodes that each node needs

/// Only folders of the programs are checked. Tests may include everything.
bool isProduct(const std::string& file) {
  return !file.starts_with("tests/") && !file.starts_with("deploy/");
}

std::vector<std::string> productCode() {
  std::vector<std::string> result;
  for (const std::string& file : sourceTree().files)
    if (isProduct(file) && test::isCode(file)) result.push_back(file);
  return result;
}

// ---- What CMake says -------------------------------------------------------------------------

struct Command {
  std::string folder;  ///< folder of its CMakeLists.txt
  std::string name;
  std::vector<std::string> words;
};

std::vector<Command> cmakeCommands() {
  static const std::regex comment("#[^\n]*"), command(R"((\w+)\s*\(([^()]*)\))"), word(R"(\S+)");
  const auto all = [](const std::string& text, const std::regex& what) {
    return std::vector<std::smatch>(std::sregex_iterator(text.begin(), text.end(), what), {});
  };
  std::vector<Command> result;
  for (const std::string& file : sourceTree().files) {
    if (!isProduct(file) || !file.ends_with("/CMakeLists.txt")) continue;
    const std::string text = std::regex_replace(sourceTree().text(file), comment, "");
    for (const std::smatch& match : all(text, command)) {
      const std::string arguments = match[2];
      Command read{folderOf(file), match[1], {}};
      for (const std::smatch& found : all(arguments, word)) read.words.push_back(found.str());
      result.push_back(std::move(read));
    }
  }
  return result;
}

/// palpate_common_mesh: the library of common/mesh.
std::string libraryOf(std::string folder) {
  std::replace(folder.begin(), folder.end(), '/', '_');
  return "palpate_" + folder;
}

/// Every folder that is a library or a program, with the folders that it links.
Graph linkedFolders() {
  const std::vector<Command> commands = cmakeCommands();
  Graph links;
  std::map<std::string, std::string> folder_of_target;
  for (const Command& command : commands) {
    if (command.words.empty()) continue;
    std::string folder = command.folder;
    if (command.name == "palpate_room") {
      folder = command.words[0];
    } else if (command.name == "add_executable" || command.name == "add_library") {
      if (command.words[1] == "ALIAS") continue;
      for (const std::string& source : command.words)
        if (source.ends_with(".cpp"))
          folder = folderOf((std::filesystem::path(folder) / source).string());
      folder_of_target[command.words[0]] = folder;
    } else {
      continue;
    }
    folder_of_target[libraryOf(folder)] = folder;
    links[folder];
  }
  for (const Command& command : commands) {
    if (command.name != "palpate_room" && command.name != "target_link_libraries") continue;
    const std::string& target = command.words[0];
    const bool is_room = command.name == "palpate_room";
    const auto owner = folder_of_target.find(is_room ? libraryOf(target) : target);
    if (owner == folder_of_target.end()) continue;
    for (const std::string& word : command.words) {
      const auto used = folder_of_target.find(links.contains(word) ? libraryOf(word) : word);
      if (used != folder_of_target.end() && used->second != owner->second)
        links[owner->second].insert(used->second);
    }
  }
  return links;
}

void addReachable(const Graph& graph, const std::string& from, Names& reached) {
  for (const std::string& next : graph.at(from))
    if (reached.insert(next).second && graph.contains(next)) addReachable(graph, next, reached);
}

// ---- What the sources say --------------------------------------------------------------------

struct Include {
  std::string from, to;  ///< files
};

/// Includes of project headers; "proto/palpate.pb.h" stands for its .proto file.
std::vector<Include> includes() {
  static const std::regex directive(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  std::vector<Include> result;
  for (const std::string& file : productCode())
    for (const std::string& line : sourceTree().lines(file)) {
      std::smatch match;
      if (!std::regex_search(line, match, directive)) continue;
      const std::string to =
          std::regex_replace(match[1].str(), std::regex(R"(\.pb\.h$)"), ".proto");
      const std::string beside = (std::filesystem::path(folderOf(file)) / to).string();
      if (sourceTree().holds(to))
        result.push_back({file, to});
      else if (sourceTree().holds(beside))
        result.push_back({file, beside});
      else if (isProduct(to) && sourceTree().folders.contains(topOf(to)))
        ADD_FAILURE() << file << " includes " << to << ", which is not there";
    }
  return result;
}

/// The common name of foo.hpp and foo.cpp: foo.
std::string unitOf(const std::string& file) {
  return (std::filesystem::path(folderOf(file)) / std::filesystem::path(file).stem()).string();
}

template <class Part>
Graph includeGraph(Part part) {
  Graph graph;
  for (const auto& [from, to] : includes()) {
    graph[part(to)];
    if (part(from) != part(to)) graph[part(from)].insert(part(to));
  }
  return graph;
}

/// One line for each node that can reach itself: "a: a needs b, b needs a" is two.
std::vector<std::string> circles(const Graph& graph) {
  std::vector<std::string> found;
  for (const auto& [node, needs] : graph) {
    Names reached;
    addReachable(graph, node, reached);
    if (!reached.contains(node)) continue;
    Names around;
    for (const std::string& next : needs) {
      Names beyond = {next};
      addReachable(graph, next, beyond);
      if (beyond.contains(node)) around.insert(next);
    }
    found.push_back(node + " needs itself by way of " + ::testing::PrintToString(around));
  }
  return found;
}

// ---- The rules -------------------------------------------------------------------------------

TEST(Architecture, EveryFolderWithCodeIsALibraryOrAProgram) {
  const Graph links = linkedFolders();
  Names homeless;
  for (const std::string& file : productCode())
    if (!links.contains(folderOf(file))) homeless.insert(folderOf(file));
  EXPECT_THAT(homeless, ::testing::IsEmpty()) << "a room of its own: palpate_room(FOLDER USES ...)";
  EXPECT_GE(links.size(), 10U) << "the CMakeLists.txt could not be parsed";
}

TEST(Architecture, IncludesOnlyPointDown) {
  const Graph links = linkedFolders();
  const std::vector<Include> all = includes();
  EXPECT_GE(all.size(), 100U);
  Names wrong;
  for (const auto& [from, to] : all) {
    const std::string folder = folderOf(from);
    Names allowed = {folder};
    if (links.contains(folder)) addReachable(links, folder, allowed);
    if (!allowed.contains(folderOf(to)))
      wrong.insert(
          fmt::format("{} includes {}, but {} does not use {}", from, to, folder, folderOf(to)));
  }
  EXPECT_THAT(wrong, ::testing::IsEmpty());
}

TEST(Architecture, NoProgramUsesAnother) {
  Names wrong;
  for (const auto& [folder, uses] : linkedFolders())
    for (const std::string& used : uses)
      if (topOf(used) != topOf(folder) && topOf(used) != "common" && topOf(used) != "proto")
        wrong.insert(fmt::format("{} uses {}", folder, used));
  EXPECT_THAT(wrong, ::testing::IsEmpty()) << "code needed by two programs belongs to common";
}

TEST(Architecture, QueriesLinkNeitherPictureNorDevices) {
  Names reached;
  addReachable(linkedFolders(), "viewer/query", reached);
  EXPECT_THAT(reached, ::testing::Contains("viewer/answers"));
  EXPECT_THAT(reached, ::testing::Not(::testing::Contains("viewer/picture")));
  EXPECT_THAT(reached, ::testing::Not(::testing::Contains("viewer/devices")));
}

TEST(Architecture, NoFoldersIncludeEachOther) {
  EXPECT_THAT(circles(includeGraph(folderOf)), ::testing::IsEmpty());
}

TEST(Architecture, NoFilesIncludeEachOther) {
  EXPECT_THAT(circles(includeGraph(unitOf)), ::testing::IsEmpty());
}

TEST(Architecture, MessagesCountInWordsOfTheRightNumber) {
  const std::regex either(R"(\{[^}"]*\}( [a-z{}]+)*\(s\))");
  std::vector<std::string> wrong;
  for (const std::string& file : sourceTree().files) {
    if (!isProduct(file) || !(test::isCode(file) || file.ends_with(".py"))) continue;
    for (const std::string& line : sourceTree().lines(file))
      if (std::regex_search(line, either)) wrong.push_back(file + ": " + line);
  }
  EXPECT_THAT(wrong, ::testing::IsEmpty()) << "\"{} node(s)\": use counted()";
}

TEST(Architecture, ClangTidyReadsEveryHeader) {
  const std::string settings = sourceTree().text(".clang-tidy");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(settings, match, std::regex("HeaderFilterRegex: *'([^']+)'")));
  const std::regex filter(match[1].str());
  Names left_out;
  for (const std::string& file : sourceTree().files)
    if (file.ends_with(".hpp") && !std::regex_search("/clone/" + file, filter))
      left_out.insert(folderOf(file));
  EXPECT_THAT(left_out, ::testing::IsEmpty()) << "HeaderFilterRegex of .clang-tidy";
}

}  // namespace
}  // namespace palpate
