#include "common/base/text_file.hpp"

#include <array>
#include <fstream>
#include <system_error>

#include "common/base/error.hpp"

namespace palpate {

std::string readText(const std::filesystem::path& file, std::string_view what) {
  std::error_code error;
  // A directory opens like a file and fails at the first read.
  if (std::filesystem::is_directory(file, error))
    throw badInput("{} {} is a directory", what, file.string());
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw badInput("{} {} cannot be opened: {}", what, file.string(),
                   std::generic_category().message(errno));
  std::string text;
  for (std::array<char, 1 << 16> chunk; in.read(chunk.data(), chunk.size()), in.gcount() > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad()) throw failure("{} {} cannot be read to its end", what, file.string());
  return text;
}

}  // namespace palpate
