#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/source_tree.hpp"

// Checks statements of the documentation about the tree.

namespace palpate {
namespace {

using test::folderOf;
using test::sourceTree;
using test::topOf;

std::vector<std::string> pages() {
  std::vector<std::string> result;
  for (const std::string& file : sourceTree().files)
    if (file.ends_with(".md")) result.push_back(file);
  return result;
}

/// A line of a page outside fenced blocks.
struct Line {
  std::string where;  ///< FILE:LINE
  std::string text;
};

std::vector<Line> proseOf(const std::string& page) {
  std::vector<Line> result;
  bool fenced = false;
  int number = 0;
  for (const std::string& line : sourceTree().lines(page)) {
    ++number;
    if (line.starts_with("```"))
      fenced = !fenced;
    else if (!fenced)
      result.push_back({page + ":" + std::to_string(number), line});
  }
  return result;
}

std::vector<std::string> allMatches(const std::string& text, const std::regex& what) {
  std::vector<std::string> result;
  for (std::sregex_iterator match(text.begin(), text.end(), what), end; match != end; ++match)
    result.push_back((*match)[1]);
  return result;
}

/// The anchors that GitHub makes of headings: lower case, hyphens for spaces, no other signs.
std::set<std::string> anchorsOf(const std::string& page) {
  std::set<std::string> anchors;
  std::map<std::string, int> seen;
  for (const Line& line : proseOf(page)) {
    std::smatch heading;
    if (!std::regex_match(line.text, heading, std::regex(R"(#{1,6} +(.*?) *)"))) continue;
    std::string anchor;
    for (const char c : heading[1].str())
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_')
        anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      else if (c == ' ')
        anchor += '-';
    const int times = seen[anchor]++;
    anchors.insert(times == 0 ? anchor : anchor + "-" + std::to_string(times));
  }
  return anchors;
}

/// The reason why a link on `page` is wrong; empty if it is right.
std::string faultOf(const std::string& link, const std::string& page) {
  const std::size_t hash = link.find('#');
  const std::string path = link.substr(0, hash);
  const std::string target =
      path.empty() ? page
                   : (std::filesystem::path(folderOf(page)) / path).lexically_normal().string();
  if (!sourceTree().holds(target)) return "there is no " + target;
  if (hash == std::string::npos) return {};
  const std::string anchor = link.substr(hash + 1);
  return anchorsOf(target).contains(anchor) ? "" : "no heading of " + target + " is #" + anchor;
}

TEST(Docs, EveryRelativeLinkLeadsSomewhere) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  std::vector<std::string> broken;
  int links = 0;
  for (const std::string& page : pages())
    for (const Line& line : proseOf(page))
      for (const std::string& to : allMatches(line.text, link)) {
        if (to.find("://") != std::string::npos) continue;
        ++links;
        const std::string fault = faultOf(to, page);
        if (!fault.empty()) broken.push_back(line.where + ": " + fault);
      }
  EXPECT_THAT(broken, ::testing::IsEmpty());
  EXPECT_GE(links, 50);
}

/// Returns whether a word between backticks names a file or folder of the project: it begins with a
/// top-level folder, or is the name of a C++ or Protobuf file. A word with NAME is a pattern.
bool namesAFile(const std::string& word) {
  if (word.find("NAME") != std::string::npos) return false;
  static const std::regex path(R"([A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)+/?)"),
      source(R"([\w/]+\.(hpp|cpp|proto))");
  return (std::regex_match(word, path) && sourceTree().folders.contains(topOf(word))) ||
         std::regex_match(word, source);
}

/// `worker/laws/laws.hpp`, `worker/laws/` and `worker/laws/laws` (.hpp and .cpp) exist; so does
/// `laws.hpp` in any folder.
bool isThere(std::string word) {
  if (word.ends_with('/')) word.pop_back();
  if (sourceTree().holds(word) || sourceTree().holds(word + ".hpp")) return true;
  for (const std::string& file : sourceTree().files)
    if (file.ends_with("/" + word)) return true;
  return false;
}

TEST(Docs, EveryFileNamedInTextExists) {
  static const std::regex code("`([^`]+)`"), word(R"(([^\s,;:()]+))");
  std::vector<std::string> missing;
  int named = 0;
  for (const std::string& page : pages())
    for (const Line& line : proseOf(page))
      for (const std::string& span : allMatches(line.text, code))
        for (const std::string& name : allMatches(span, word)) {
          if (!namesAFile(name)) continue;
          ++named;
          if (!isThere(name)) missing.push_back(line.where + ": there is no " + name);
        }
  EXPECT_THAT(missing, ::testing::IsEmpty());
  EXPECT_GE(named, 50);
}

TEST(Docs, EveryPageNamedInCodeExists) {
  static const std::regex page(R"(\b(docs/[\w/-]+\.md))");
  std::vector<std::string> missing;
  for (const std::string& file : sourceTree().files) {
    if (file.ends_with(".md") || !(test::isCode(file) || file.ends_with(".proto"))) continue;
    for (const std::string& name : allMatches(sourceTree().text(file), page))
      if (!sourceTree().holds(name))
        missing.push_back(fmt::format("{}: there is no {}", file, name));
  }
  EXPECT_THAT(missing, ::testing::IsEmpty());
}

/// A test folder that mirrors a program's folder is explained by that folder's README.
bool isMirror(const std::string& folder) {
  return folder.starts_with("tests/") && sourceTree().folders.contains(folder.substr(6));
}

/// A folder with code, or with subfolders that have code.
bool holdsCode(const std::string& folder) {
  for (const std::string& file : sourceTree().files)
    if (file.starts_with(folder + "/") && (test::isCode(file) || file.ends_with(".proto")))
      return true;
  return false;
}

TEST(Docs, EveryCodeFolderHasAReadmeOfAtMostFifteenLines) {
  std::vector<std::string> wrong;
  for (const std::string& folder : sourceTree().folders) {
    const std::string above = folderOf(folder);
    if (folder.empty() || !holdsCode(folder) || isMirror(folder) || above == "deploy/examples")
      continue;
    const std::string readme = folder + "/README.md";
    if (!sourceTree().holds(readme))
      wrong.push_back(folder + " has no README.md");
    else if (sourceTree().lines(readme).size() > 15)
      wrong.push_back(readme + " has more than 15 lines");
  }
  EXPECT_THAT(wrong, ::testing::IsEmpty());
}

/// Checks every `Suite.Case` named on pages with promises.
TEST(Docs, EveryTestNamedOnAPageExists) {
  std::set<std::string> tests;
  const std::regex begins(R"(^TEST(_F|_P)?\((\w+), *(\w+)\))");
  for (const std::string& file : sourceTree().files)
    if (file.ends_with("_test.cpp"))
      for (const std::string& line : sourceTree().lines(file))
        if (std::smatch found; std::regex_search(line, found, begins))
          tests.insert(found.str(2) + "." + found.str(3));
  std::vector<std::string> missing;
  int named = 0;
  const std::regex name("`([A-Z]\\w+\\.[A-Z]\\w+)`");
  for (const char* page : {"docs/service.md", "docs/security.md"})
    for (const Line& line : proseOf(page))
      for (std::sregex_iterator at(line.text.begin(), line.text.end(), name), end; at != end;
           ++at) {
        ++named;
        if (!tests.contains(at->str(1))) missing.push_back(line.where + ": " + at->str(1));
      }
  EXPECT_THAT(missing, ::testing::IsEmpty());
  EXPECT_GT(named, 30);
}

}  // namespace
}  // namespace palpate
