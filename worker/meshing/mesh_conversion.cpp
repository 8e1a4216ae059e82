#include "worker/meshing/mesh_conversion.hpp"

#include <array>
#include <map>
#include <sstream>

#include "common/base/error.hpp"

namespace palpate {

extern const char* const convert_mesh_py;  ///< the script, made by CMake

namespace {

/// Exit codes of the script.
constexpr int script_wrong_input = 2, script_missing_module = 3;

/// The Debian package of a Python module.
std::string packageOf(const std::string& module) {
  static const std::map<std::string, std::string> packages = {{"netCDF4", "python3-netcdf4"},
                                                              {"h5py", "python3-h5py"}};
  const auto found = packages.find(module);
  return found != packages.end() ? found->second : "python3-" + module;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

/// By the Python that Debian's packages are of, or by the user's own where that has what it needs.
Ran runScript(const std::vector<std::string>& arguments) {
  Ran ran;
  std::string missing;
  for (const char* python : {"/usr/bin/python3", "python3"}) {
    if (!isInstalled(python)) continue;
    std::vector<std::string> words = {python, "-B", "-"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    ran = runMeshing({.words = words, .package = "python3", .input = convert_mesh_py});
    if (ran.exit_code != script_missing_module) return ran;
    // Of Debian's, where there is one: its packages are what is told to install.
    if (missing.empty() && !linesOf(ran.err).empty()) missing = linesOf(ran.err).back();
  }
  if (missing.empty())
    throw failure("python3 is not installed here, or not in $PATH (Debian: python3-meshio)");
  throw failure("{} cannot be read: Python's module {} is not installed here (Debian: {})",
                arguments.at(0), missing, packageOf(missing));
}

}  // namespace

ConvertedMesh convertMesh(const std::filesystem::path& input, const std::filesystem::path& folder,
                          ConversionWishes wishes) {
  std::error_code ignored;
  if (!std::filesystem::exists(input, ignored))
    throw badInput("{}: there is no such file", input.string());
  if (std::filesystem::is_directory(input, ignored))
    throw badInput("{}: is a folder; give a mesh file", input.string());
  ConvertedMesh converted;
  converted.file = folder / "converted.msh";
  std::vector<std::string> arguments = {input.string(), converted.file.string()};
  if (wishes.straight) arguments.emplace_back("--straight");
  if (wishes.weld) arguments.emplace_back("--weld");
  const Ran ran = runScript(arguments);
  const std::vector<std::string> said = linesOf(ran.err);
  if (ran.exit_code == script_wrong_input)
    throw badInput("{}", said.empty() ? input.string() + ": cannot be read" : said.back());
  std::vector<std::string> answer = linesOf(ran.out);
  if (ran.exit_code != 0 || answer.empty())
    throw failure("{}: its conversion by Python failed (exit code {}): {}", input.string(),
                  ran.exit_code, said.empty() ? "it does not say why" : said.back());
  converted.is_volume = answer.front() == "volume";
  converted.notes.assign(answer.begin() + 1, answer.end());
  return converted;
}

}  // namespace palpate
