#include "viewer/picture/image.hpp"

#include <fmt/format.h>
#include <stb_image_write.h>

#include <string>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {

void writePng(const Image& image, const std::filesystem::path& file) {
  PALPATE_ASSERT(std::ssize(image.pixels) == std::ptrdiff_t{3} * image.width * image.height,
                 "an image must have all its pixels");
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                          static_cast<std::size_t>(size));
  };
  if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.pixels.data(),
                             3 * image.width) == 0)
    throw failure("{}: a picture of {} x {} pixels cannot be written as PNG", file.string(),
                  image.width, image.height);
  replaceFile(file, bytes, "picture");
}

VideoFrames::VideoFrames(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code refused;
  std::filesystem::create_directories(folder_, refused);
  if (refused)
    throw failure("{}: cannot create the folder for frames: {}", folder_.string(),
                  refused.message());
  for (const auto& entry : std::filesystem::directory_iterator(folder_, refused))
    if (entry.path().filename().string().starts_with("frame-"))
      throw badInput("{} already contains frames ({}); choose another folder, or empty this one",
                     folder_.string(), entry.path().filename().string());
  if (refused)
    throw failure("{}: cannot read the folder for frames: {}", folder_.string(), refused.message());
}

void VideoFrames::add(const Image& image) {
  writePng(image, folder_ / fmt::format("frame-{:06}.png", count_ + 1));
  ++count_;
}

}  // namespace palpate
