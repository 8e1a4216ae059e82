#include "common/base/assertion.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace palpate {

void assertionFailed(const char* condition, const char* why, const char* file, int line) {
  throw std::logic_error(fmt::format("{}:{}: {} does not hold: {}", file, line, condition, why));
}

}  // namespace palpate
