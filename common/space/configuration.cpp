#include "common/space/configuration.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/base/error.hpp"

namespace palpate {

static_assert(std::endian::native == std::endian::little,
              "memory must be little-endian, as in files and messages");

std::string NodalFields::encode() const {
  std::string bytes(bytesOf(std::span(displacement)));
  bytes += bytesOf(std::span(pressure));
  return bytes;
}

NodalFields NodalFields::decode(std::string_view bytes, std::size_t n_nodes,
                                std::size_t n_pressures) {
  const std::size_t expected = (3 * n_nodes + n_pressures) * sizeof(float);
  if (bytes.size() != expected)
    throw failure("nodal fields have {} bytes, but a mesh with {} nodes and {} pressures needs {}",
                  bytes.size(), n_nodes, n_pressures, expected);
  NodalFields fields = {std::vector<float>(3 * n_nodes), std::vector<float>(n_pressures)};
  for (std::vector<float>* values : {&fields.displacement, &fields.pressure}) {
    const std::size_t length = values->size() * sizeof(float);
    // Do not use memcpy, which must not get the null pointer of an empty array.
    std::ranges::copy(bytes.substr(0, length), reinterpret_cast<char*>(values->data()));
    bytes.remove_prefix(length);
    for (const float value : *values)
      // Refuse NaN and infinity here. Newton's method would start from them and fail elsewhere.
      if (!std::isfinite(value)) throw failure("nodal fields hold a value that is not finite");
  }
  return fields;
}

bool isUsable(const Equilibrium& e) {
  // Returns false for NaN too.
  const auto is = [](const auto& values) { return (values.array().abs() <= largest_stored).all(); };
  return is(e.force) && is(e.stiffness) && std::abs(e.energy) <= largest_stored &&
         std::abs(e.min_det_F) <= largest_stored && is(e.drive) && is(e.drive_stiffness) &&
         is(e.drive_slope) && is(e.stiffness_by_p) && is(e.stiffness_by_s) &&
         is(e.drive_slope_by_p);
}

ContentId NodalFields::id() const { return ContentId::of(encode()); }

}  // namespace palpate
