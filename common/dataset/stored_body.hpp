#pragma once

#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The body as a dataset stores it.
struct StoredBody {
  Mesh mesh;                          ///< without groups; quadratic with P2 displacement
  std::vector<std::int32_t> fixed;    ///< sorted
  std::vector<std::int32_t> surface;  ///< surfaceNodes(mesh)
  std::vector<std::int32_t> stored;   ///< storedNodes of the scene
};

}  // namespace palpate
