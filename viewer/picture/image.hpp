#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate {

/// Pixels of a picture.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< height x width x 3: rows from the top, red, green, blue
};

/// Writes a PNG file: aside as FILE.tmp, then renamed, so that FILE is the old one or whole. Error
/// that names the file; nothing is left behind then.
void writePng(const Image& image, const std::filesystem::path& file);

/// The pictures of a run as numbered files: DIR/frame-000001.png, ... They become a film by any
/// program that reads numbered pictures.
class VideoFrames {
 public:
  /// Makes the folder where it is missing. Error when that fails, or when it holds frames already:
  /// two runs would mix.
  explicit VideoFrames(std::filesystem::path folder);
  /// Error as writePng's.
  void add(const Image& image);
  int count() const { return count_; }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

}  // namespace palpate
