#include "tests/simulation/planted.hpp"

#include <array>

namespace palpate::simulation {
namespace {

#ifdef PALPATE_PLANTED
constexpr auto defects = std::to_array<Defect>({
#include "planted_defects.inc"
});
#endif
std::string present;

}  // namespace

std::span<const Defect> plantedDefects() {
#ifdef PALPATE_PLANTED
  return defects;
#else
  return {};
#endif
}

void plant(const std::string& name) { present = name; }

#ifdef PALPATE_PLANTED
/// Called where a defect was planted.
bool planted(const char* defect);
bool planted(const char* defect) { return present == defect; }
#endif

}  // namespace palpate::simulation
