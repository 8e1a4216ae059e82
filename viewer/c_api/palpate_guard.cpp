#include <array>
#include <cmath>

#include "common/scene/device_profile.hpp"
#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/touch_struct.hpp"
#include "viewer/haptics/force_guard.hpp"

using namespace palpate;

struct palpate_guard {
  ForceGuard guard;
};

static_assert(guard_count == 9 &&
              PALPATE_GUARD_RAMPED == static_cast<std::uint32_t>(Guarded::ramped) &&
              PALPATE_GUARD_DAMPED == static_cast<std::uint32_t>(Guarded::damped) &&
              PALPATE_GUARD_CLAMPED == static_cast<std::uint32_t>(Guarded::clamped) &&
              PALPATE_GUARD_SLEWED == static_cast<std::uint32_t>(Guarded::slewed) &&
              PALPATE_GUARD_STALLED == static_cast<std::uint32_t>(Guarded::stalled) &&
              PALPATE_GUARD_LOST == static_cast<std::uint32_t>(Guarded::lost) &&
              PALPATE_GUARD_NOT_FINITE == static_cast<std::uint32_t>(Guarded::not_finite) &&
              PALPATE_GUARD_LATE == static_cast<std::uint32_t>(Guarded::late) &&
              PALPATE_GUARD_BEYOND == static_cast<std::uint32_t>(Guarded::beyond));

namespace {

constexpr std::uint32_t known_flags =
    PALPATE_READING_FRESH | PALPATE_READING_LOST | PALPATE_LOOP_LATE;

const DeviceProfile* profileNamed(const char* function, std::string_view name) {
  const DeviceProfile* const found = deviceNamed(name);
  if (found == nullptr)
    refuse("{}: unknown device \"{}\"; known: {}", function, name, fmt::join(device_words, ", "));
  return found;
}

/// Largest delay that ForceGuard accepts, periods.
constexpr std::uint32_t most_delay = EnergyLimit::remembered - 2;

using Options = palpate_guard_options;
constexpr std::array<OptionNumber<Options, GuardOptions>, 8> limits = {
    {{"options->period", Least::above_zero, &Options::period, &GuardOptions::period},
     {"options->max_force", Least::above_zero, &Options::max_force, &GuardOptions::max_force},
     {"options->max_slew", Least::zero, &Options::max_slew, &GuardOptions::max_slew},
     {"options->ramp", Least::above_zero, &Options::ramp, &GuardOptions::ramp},
     {"options->stall", Least::above_zero, &Options::stall, &GuardOptions::stall},
     {"options->max_stiffness", Least::above_zero, &Options::max_stiffness,
      &GuardOptions::max_stiffness},
     {"options->energy_credit", Least::zero, &Options::energy_credit, &GuardOptions::energy_credit},
     {"options->delay", Least::zero, &Options::delay, &GuardOptions::delay}}};

Options toStruct(const GuardOptions& options) noexcept {
  Options given{};
  given.size = sizeof given;
  fillIn(given, options, limits);
  return given;
}

/// Checks the arguments of palpate_guard_limit. Sets `guarded` to zero first, if it can be written.
bool canBeLimited(const char* function, const palpate_guard* guard, const double tool[3],
                  const palpate_touch* touch, std::uint32_t flags,
                  palpate_guarded_force* guarded) noexcept {
  if (!sizeIsKnown(function, "guarded", guarded)) return false;
  // Set the force to zero first, so that a caller that ignores the status does no harm.
  give(guarded, palpate_guarded_force{});
  if (!isThere(function, "guard", guard) || !isThere(function, "tool", tool) ||
      !sizeIsKnown(function, "touch", touch))
    return false;
  // A flag of a later version may mean "stop", so giving no force is safer than ignoring the flag.
  return (flags & ~known_flags) == 0 ||
         refuse("{}: flags {:#x} contains unknown bits; see palpate.h", function, flags);
}

}  // namespace

palpate_status palpate_device_profile(const char* name, palpate_profile* device) {
  if (!isThere(__func__, "name", name) || !sizeIsKnown(__func__, "device", device))
    return PALPATE_INVALID_ARGUMENT;
  const DeviceProfile* const profile = profileNamed(__func__, name);
  if (profile == nullptr) return PALPATE_INVALID_ARGUMENT;
  give(device, palpate_profile{.size = sizeof(palpate_profile),
                               .name = profile->name.data(),  // a literal ends with a zero
                               .max_force = profile->max_force,
                               .max_stiffness = profile->max_stiffness,
                               .workspace_radius = profile->workspace_radius});
  return PALPATE_OK;
}

palpate_status palpate_guard_defaults(const char* device, double period,
                                      palpate_guard_options* options) {
  if (!isFinite(__func__, "period", period, Least::above_zero) ||
      !sizeIsKnown(__func__, "options", options))
    return PALPATE_INVALID_ARGUMENT;
  GuardOptions chosen;
  if (device != nullptr) {
    const DeviceProfile* const profile = profileNamed(__func__, device);
    if (profile == nullptr) return PALPATE_INVALID_ARGUMENT;
    chosen = guardFor(*profile, period);
  }
  chosen.period = period;
  give(options, toStruct(chosen));
  return PALPATE_OK;
}

palpate_status palpate_guard_create(const palpate_guard_options* options, palpate_guard** guard) {
  if (!isThere(__func__, "guard", guard)) return PALPATE_INVALID_ARGUMENT;
  *guard = nullptr;
  GuardOptions chosen;
  palpate_guard_options given = toStruct(chosen);
  if (!takeOptions(__func__, options, given)) return PALPATE_INVALID_ARGUMENT;
  if (std::isnan(given.max_slew)) given.max_slew = 0;
  if (!takeOver(__func__, given, chosen, limits)) return PALPATE_INVALID_ARGUMENT;
  if (chosen.delay > most_delay * chosen.period)
    return fail(PALPATE_INVALID_ARGUMENT, "{}: options->delay is {}; it must be at most {} periods",
                __func__, chosen.delay, most_delay);
  return withoutExceptions(__func__, [&] { *guard = new palpate_guard{ForceGuard(chosen)}; });
}

void palpate_guard_destroy(palpate_guard* guard) { delete guard; }

palpate_status palpate_guard_limit(palpate_guard* guard, const double tool[3],
                                   const palpate_touch* touch, std::uint32_t flags,
                                   palpate_guarded_force* guarded) {
  if (!canBeLimited(__func__, guard, tool, touch, flags, guarded)) {
    if (guard != nullptr)
      guard->guard.reset();  // the hand gets zero force, so the next force must start from zero
    return PALPATE_INVALID_ARGUMENT;
  }
  const GuardedForce limited =
      guard->guard.limit({.tool = vectorOf(tool),
                          .touch = toTouch(taken(touch, toStruct(Touch{}))),
                          .fresh = (flags & PALPATE_READING_FRESH) != 0,
                          .lost = (flags & PALPATE_READING_LOST) != 0,
                          .late = (flags & PALPATE_LOOP_LATE) != 0});
  palpate_guarded_force given{};
  give(given.force, limited.force);
  given.passivity = limited.passivity;
  given.guards = limited.guards;
  give(guarded, given);
  return PALPATE_OK;
}

palpate_status palpate_guard_reset(palpate_guard* guard) {
  if (!isThere(__func__, "guard", guard)) return PALPATE_INVALID_ARGUMENT;
  guard->guard.reset();
  return PALPATE_OK;
}
