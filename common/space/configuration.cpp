#include "common/space/configuration.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/base/error.hpp"

namespace palpate {

static_assert(std::endian::native == std::endian::little,
              "files and messages hold little-endian arrays as they are in memory");

std::string NodalFields::encode() const {
  std::string bytes(bytesOf(std::span(displacement)));
  bytes += bytesOf(std::span(pressure));
  return bytes;
}

NodalFields NodalFields::decode(std::string_view bytes, std::size_t n_nodes,
                                std::size_t n_pressures) {
  const std::size_t displacement_bytes = 3 * n_nodes * sizeof(float);
  const std::size_t pressure_bytes = n_pressures * sizeof(float);
  if (bytes.size() != displacement_bytes + pressure_bytes)
    throw failure(
        "nodal fields of {} bytes do not belong to a mesh of {} nodes, "
        "{} with a pressure ({} bytes)",
        bytes.size(), n_nodes, n_pressures, displacement_bytes + pressure_bytes);
  NodalFields fields;
  fields.displacement.resize(3 * n_nodes);
  std::ranges::copy(bytes.substr(0, displacement_bytes),
                    reinterpret_cast<char*>(fields.displacement.data()));
  fields.pressure.resize(n_pressures);
  // Not memcpy, which must not be given the null pointer of an empty array.
  std::ranges::copy(bytes.substr(displacement_bytes),
                    reinterpret_cast<char*>(fields.pressure.data()));
  for (const auto* values : {&fields.displacement, &fields.pressure})
    for (const float value : *values)
      // Newton would start from it and fail far from the cause.
      if (!std::isfinite(value)) throw failure("nodal fields hold a value that is not finite");
  return fields;
}

ContentId NodalFields::id() const { return ContentId::of(encode()); }

}  // namespace palpate
