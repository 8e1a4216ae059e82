#include "common/space/result_key.hpp"

#include <fmt/core.h>

namespace palpate {

std::string textOf(const ResultKey& key) {
  const auto& [space, target, parent] = key;
  return fmt::format("space {}, point ({}, {}, {}), solved from ({}, {}, {})", space, target[0],
                     target[1], target[2], parent[0], parent[1], parent[2]);
}

}  // namespace palpate
