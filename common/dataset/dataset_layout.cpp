#include "common/dataset/dataset_layout.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::layout {

ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays) {
  std::sort(arrays.begin(), arrays.end(),
            [](const hdf5::ArrayInfo& a, const hdf5::ArrayInfo& b) { return a.path < b.path; });
  std::string text = fmt::format("scene_toml {}\n", ContentId::of(scene_toml).hex());
  for (const hdf5::ArrayInfo& array : arrays) {
    const std::string shape =
        array.shape.empty() ? "scalar" : fmt::format("{}", fmt::join(array.shape, "x"));
    text += fmt::format("{} {} {} {}\n", array.path, hdf5::name(array.element), shape,
                        array.hash.hex());
  }
  return ContentId::of(text);
}

Quantized quantize(std::span<const float> displacement) {
  constexpr double largest_integer = 32767;
  double largest = 0;
  for (const float value : displacement)
    largest = std::max(largest, std::abs(static_cast<double>(value)));
  Quantized quantized;
  quantized.step = static_cast<float>(largest / largest_integer);
  quantized.values.reserve(displacement.size());
  for (const float value : displacement) {
    // The step is zero where everything is, and where its quotient is too small for a float.
    const double steps = quantized.step > 0 ? value / static_cast<double>(quantized.step) : 0;
    quantized.values.push_back(static_cast<std::int16_t>(
        std::clamp(std::round(steps), -largest_integer, largest_integer)));
  }
  return quantized;
}

ContentId rowHash(std::string_view displacement, const float* step,
                  std::span<const float> pressure) {
  ContentHasher hasher;
  hasher.add(displacement);
  if (step != nullptr) hasher.add(bytesOf(std::span(step, 1)));
  hasher.add(bytesOf(pressure));
  return hasher.finish();
}

}  // namespace palpate::layout
