#include "common/displacement_input.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include "common/error.hpp"

namespace palpate {
namespace {

Eigen::Vector3d parse(const std::vector<std::string>& words, const std::string& where) {
  if (words.size() != 3)
    throw badInput("{}: {} numbers instead of 3; write X Y Z in metres", where, words.size());
  Eigen::Vector3d displacement;
  for (int i = 0; i < 3; ++i) {
    const std::string& word = words[i];
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(begin, end, displacement[i]);
    if (error != std::errc() || stop != end || !std::isfinite(displacement[i]))
      throw badInput("{}: \"{}\" is not a number", where, word);
  }
  return displacement;
}

}  // namespace

CLI::Option* addDisplacementOption(CLI::App& app, std::vector<std::string>& words) {
  return app.add_option("--displacement", words, "X Y Z of the tool in metres, or - to read one per line")
      ->required()
      ->expected(1, 3);
}

void forEachDisplacement(const std::vector<std::string>& words, std::istream& input,
                         const std::function<void(const Eigen::Vector3d&)>& visit) {
  if (words != std::vector<std::string>{"-"}) {
    visit(parse(words, "--displacement"));
    return;
  }
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    std::istringstream stream(line);
    std::vector<std::string> numbers;
    for (std::string word; stream >> word;) numbers.push_back(word);
    if (numbers.empty() || numbers.front().starts_with('#')) continue;
    visit(parse(numbers, "line " + std::to_string(number)));
  }
  if (input.bad()) throw failure("standard input could not be read");
}

}  // namespace palpate
