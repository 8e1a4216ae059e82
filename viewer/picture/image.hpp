#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpate {

/// The pixels of a picture.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< height x width x 3: rows from the top; red, green, blue
};

/// Writes a PNG file. Writes FILE.tmp first and renames it, so FILE is always either the old file
/// or a complete new one. Throws Error with the name of the file, and then leaves nothing behind.
void writePng(const Image& image, const std::filesystem::path& file);

/// Frames of a run as numbered files (DIR/frame-000001.png and so on), which video encoders can
/// read.
class VideoFrames {
 public:
  /// Creates the folder if it is missing. Throws Error if that fails, or if the folder already
  /// contains frames, which would be mixed with the new ones.
  explicit VideoFrames(std::filesystem::path folder);
  /// Writes the next frame. Throws Error like writePng().
  void add(const Image& image);
  int count() const { return count_; }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

}  // namespace palpate
