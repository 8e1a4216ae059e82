#include "scheduler/state/result_key.hpp"

#include "common/wire/wire.hpp"

namespace palpate {

ResultKey keyOf(const wire::Result& result) {
  return {result.space(), fromWire(result.target()), fromWire(result.parent())};
}

std::string textOf(const ResultKey& key) {
  const auto& [space, target, parent] = key;
  return fmt::format("space {}, point ({}, {}, {}) from ({}, {}, {})", space, target[0], target[1],
                     target[2], parent[0], parent[1], parent[2]);
}

}  // namespace palpate
