#include <array>
#include <memory>

#include "common/base/assertion.hpp"
#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/live_scene.hpp"
#include "viewer/c_api/touch_struct.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/deformed_shape.hpp"

using namespace palpate;

struct palpate_contact {
  palpate_contact(const palpate_dataset& dataset, const ContactOptions& options,
                  std::int32_t method, std::shared_ptr<LiveScene> scene)
      : loaded(dataset.loaded), live(std::move(scene)), contact(loaded->model, options) {
    PALPATE_ASSERT(at(method) < loaded->model.methods().size(),
                   "the interpolation method must exist");
    contact.use(loaded->model, at(method));
  }
  ~palpate_contact() {
    if (live) live->in_use = false;
  }
  palpate_contact(const palpate_contact&) = delete;
  palpate_contact& operator=(const palpate_contact&) = delete;

  std::shared_ptr<const LoadedDataset> loaded;
  std::shared_ptr<LiveScene> live;  ///< null: no live solver
  Contact contact;
};

namespace {

using Given = palpate_contact_options;
constexpr std::array<OptionNumber<Given, ContactOptions>, 4> numbers = {
    {{"options->friction", Least::zero, &Given::friction, &ContactOptions::friction},
     {"options->grab_distance", Least::zero, &Given::grab_distance, &ContactOptions::grab_distance},
     {"options->most_slide", Least::above_zero, &Given::most_slide, &ContactOptions::most_slide},
     {"options->most_relaxation", Least::above_zero, &Given::most_relaxation,
      &ContactOptions::most_relaxation}}};

Given defaultsFor(const palpate_dataset& dataset) noexcept {
  Given given{};
  given.size = sizeof given;
  given.mode = dataset.loaded->info.contact_mode;
  fillIn(given, ContactOptions{}, numbers);
  return given;
}

/// Converts the caller's options to the library's. Records the failure and returns false if an
/// option is invalid.
bool translate(const char* function, const Given& options, const palpate_dataset& dataset,
               ContactOptions& chosen) noexcept {
  if (options.mode != PALPATE_UNILATERAL && options.mode != PALPATE_GLUED)
    return refuse("{}: options->mode is {}; it must be PALPATE_UNILATERAL or PALPATE_GLUED",
                  function, options.mode);
  chosen.mode = options.mode == PALPATE_GLUED ? ContactMode::glued : ContactMode::unilateral;
  if (options.live != nullptr) {
    LiveScene& scene = *options.live->scene;
    if (scene.loaded != dataset.loaded)
      return refuse("{}: options->live belongs to another dataset; use palpate_live_dataset",
                    function);
    chosen.live = &scene.touch;
    chosen.live_model = &scene.loaded->model;
    chosen.period = scene.period;
  }
  return takeOver(function, options, chosen, numbers) &&
         isNumber(function, "method", options.method, dataset.loaded->info.method_count);
}

/// Returns whether the triangle and the spaces of a touch exist in a dataset; the caller may have
/// filled in the touch by hand.
bool belongsTo(const char* function, const palpate_touch& touch,
               const palpate_dataset_info& info) noexcept {
  // The other members of a touch without contact are not read.
  if (touch.touching == 0) return true;
  if (!isNumber(function, "triangle", touch.triangle, info.triangle_count)) return false;
  if (touch.share_count < 1 || touch.share_count > PALPATE_MOST_SHARES)
    return refuse("{}: touch->share_count is {}; it must be from 1 to {}", function,
                  touch.share_count, PALPATE_MOST_SHARES);
  for (std::int32_t s = 0; s < touch.share_count; ++s)
    if (!isNumber(function, "space", touch.share_spaces[s], info.space_count)) return false;
  return true;
}

}  // namespace

palpate_status palpate_contact_defaults(const palpate_dataset* dataset,
                                        palpate_contact_options* options) {
  if (!isThere(__func__, "dataset", dataset) || !sizeIsKnown(__func__, "options", options))
    return PALPATE_INVALID_ARGUMENT;
  give(options, defaultsFor(*dataset));
  return PALPATE_OK;
}

palpate_status palpate_contact_create(const palpate_dataset* dataset,
                                      const palpate_contact_options* options,
                                      palpate_contact** contact) {
  if (!isThere(__func__, "contact", contact)) return PALPATE_INVALID_ARGUMENT;
  *contact = nullptr;
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  palpate_contact_options given = defaultsFor(*dataset);
  ContactOptions chosen;
  if (!takeOptions(__func__, options, given) || !translate(__func__, given, *dataset, chosen))
    return PALPATE_INVALID_ARGUMENT;
  const std::shared_ptr<LiveScene> live = given.live != nullptr ? given.live->scene : nullptr;
  if (live && live->in_use.exchange(true))
    return fail(PALPATE_INVALID_ARGUMENT,
                "{}: another contact uses options->live; destroy it first", __func__);
  const palpate_status status = withoutExceptions(
      __func__, [&] { *contact = new palpate_contact(*dataset, chosen, given.method, live); });
  if (live && status != PALPATE_OK) live->in_use = false;
  return status;
}

void palpate_contact_destroy(palpate_contact* contact) { delete contact; }

palpate_status palpate_contact_update(palpate_contact* contact, const double tool[3],
                                      std::int32_t hold, palpate_touch* touch) {
  if (!isThere(__func__, "contact", contact) || !isThere(__func__, "tool", tool) ||
      !sizeIsKnown(__func__, "touch", touch))
    return PALPATE_INVALID_ARGUMENT;
  give(touch, toStruct(contact->contact.update(vectorOf(tool), hold != 0)));
  return PALPATE_OK;
}

palpate_status palpate_contact_release(palpate_contact* contact) {
  if (!isThere(__func__, "contact", contact)) return PALPATE_INVALID_ARGUMENT;
  contact->contact.release();
  return PALPATE_OK;
}

palpate_status palpate_contact_use(palpate_contact* contact, const palpate_dataset* dataset,
                                   std::int32_t method) {
  if (!isThere(__func__, "contact", contact) || !isThere(__func__, "dataset", dataset) ||
      !isNumber(__func__, "method", method, dataset->loaded->info.method_count))
    return PALPATE_INVALID_ARGUMENT;
  // use() compares the two models, so the previous model must stay alive until use() returns.
  const std::shared_ptr<const LoadedDataset> former = contact->loaded;
  contact->loaded = dataset->loaded;
  contact->contact.use(contact->loaded->model, at(method));
  return PALPATE_OK;
}

palpate_status palpate_touch_displacements(const palpate_dataset* dataset,
                                           const palpate_touch* touch, float* displacements,
                                           std::size_t capacity) {
  if (!isThere(__func__, "dataset", dataset) || !sizeIsKnown(__func__, "touch", touch) ||
      !isThere(__func__, "displacements", displacements))
    return PALPATE_INVALID_ARGUMENT;
  const palpate_dataset_info& info = dataset->loaded->info;
  const palpate_touch known = taken(touch, toStruct(Touch{}));
  const std::size_t needed = countOf(info.vertex_count);
  if (!isEnough(__func__, capacity, needed) || !belongsTo(__func__, known, info))
    return PALPATE_INVALID_ARGUMENT;
  return withoutExceptions(__func__, [&] {
    DeformedShape shape(at(info.vertex_count));
    shape.evaluate(dataset->loaded->model, toTouch(known), {displacements, needed});
  });
}
