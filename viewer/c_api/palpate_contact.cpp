#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "common/base/assertion.hpp"
#include "common/base/machine.hpp"
#include "common/base/thread_pool.hpp"
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

struct palpate_contacts {
  palpate_contacts(const palpate_dataset& dataset, const ContactOptions& options,
                   std::int32_t method, std::size_t n, std::size_t n_threads)
      : loaded(dataset.loaded),
        contacts(n, Contact(loaded->model, options)),
        order(n),
        threads(n_threads) {
    for (Contact& contact : contacts) contact.use(loaded->model, at(method));
    for (const Eigen::Vector3d& vertex : loaded->model.surface().vertices()) box.extend(vertex);
    for (std::size_t c = 0; c < n; ++c) order[c].contact = c;
  }

  /// Sorts `order` along a Z-order curve through the positions, 3 per contact, m.
  void sort(const double* tools) noexcept {
    for (Placed& placed : order) {
      const Eigen::Vector3d share =
          (vectorOf(tools + 3 * placed.contact) - box.min()).cwiseQuotient(box.sizes());
      placed.code = 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        // In this order, NaN becomes 0.
        const auto cell =
            static_cast<std::uint32_t>(std::min(63.0, std::max(0.0, 64 * share[axis])));
        for (std::uint32_t bit = 0; bit < 6; ++bit)
          placed.code |= (cell >> bit & 1) << (3 * bit + static_cast<std::uint32_t>(axis));
      }
    }
    std::ranges::sort(order, {}, &Placed::code);
  }

  struct Placed {
    std::size_t contact;
    std::uint32_t code = 0;
  };
  const std::shared_ptr<const LoadedDataset> loaded;
  std::vector<Contact> contacts;
  /// Order in which contacts are updated. Neighbours read the same part of the dataset, which then
  /// still is in the cache.
  std::vector<Placed> order;
  std::uint64_t updates = 0;
  Eigen::AlignedBox3d box;  ///< of the surface at rest, m
  ThreadPool threads;
};

namespace {

/// Number of contacts that a thread updates before it takes the next ones.
constexpr std::size_t contacts_at_once = 16;
/// Number of updates after which the contacts are sorted again by their place.
constexpr std::uint64_t updates_per_sort = 32;
constexpr std::int32_t most_threads = 1024;
constexpr std::size_t most_contacts = 1u << 24;

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

/// Takes the caller's options, or the defaults if they are NULL. Records the failure and returns
/// false if an option is invalid.
bool choose(const char* function, const palpate_contact_options* options,
            const palpate_dataset& dataset, Given& given, ContactOptions& chosen) noexcept {
  given = defaultsFor(dataset);
  return takeOptions(function, options, given) && translate(function, given, dataset, chosen);
}

/// Copies a touch into element n of each of the caller's arrays that is not NULL.
void giveTouch(const palpate_touches& to, std::size_t n, const Touch& touch) noexcept {
  const auto number = [n](auto* array, auto value) {
    if (array != nullptr) array[n] = static_cast<std::remove_pointer_t<decltype(array)>>(value);
  };
  const auto vector = [n](double* array, const Eigen::Vector3d& value) {
    if (array != nullptr) give(array + 3 * n, value);
  };
  number(to.touching, touch.touching);
  number(to.stepped, touch.stepped);
  number(to.inside, touch.inside);
  number(to.triangles, touch.anchor.triangle);
  vector(to.forces, touch.force);
  if (to.stiffnesses != nullptr) give(to.stiffnesses + 9 * n, touch.stiffness);
  number(to.energies, touch.energy);
  number(to.error_bounds, touch.error_bound);
  number(to.coverages, touch.coverage);
  vector(to.anchors, touch.anchor_position);
  vector(to.normals, touch.normal);
  vector(to.displacements, touch.displacement);
  number(to.gaps, touch.gap);
  number(to.beyond, touch.beyond);
  vector(to.drives, touch.drive);
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
  Given given;
  ContactOptions chosen;
  if (!choose(__func__, options, *dataset, given, chosen)) return PALPATE_INVALID_ARGUMENT;
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

palpate_status palpate_contacts_create(const palpate_dataset* dataset,
                                       const palpate_contact_options* options, std::size_t n,
                                       std::int32_t threads, palpate_contacts** contacts) {
  if (!isThere(__func__, "contacts", contacts)) return PALPATE_INVALID_ARGUMENT;
  *contacts = nullptr;
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  Given given;
  ContactOptions chosen;
  if (!choose(__func__, options, *dataset, given, chosen)) return PALPATE_INVALID_ARGUMENT;
  if (given.live != nullptr)
    return fail(PALPATE_INVALID_ARGUMENT,
                "{}: options->live must be NULL; a live solver follows a single contact", __func__);
  if (n > most_contacts)
    return fail(PALPATE_INVALID_ARGUMENT, "{}: n is {}; it must be at most {}", __func__, n,
                most_contacts);
  if (threads < 0 || threads > most_threads)
    return fail(PALPATE_INVALID_ARGUMENT, "{}: threads is {}; it must be from 0 to {}", __func__,
                threads, most_threads);
  return withoutExceptions(__func__, [&] {
    *contacts = new palpate_contacts(*dataset, chosen, given.method, n,
                                     threads == 0 ? coreCount() : at(threads));
  });
}

void palpate_contacts_destroy(palpate_contacts* contacts) { delete contacts; }

palpate_status palpate_contacts_set_frictions(palpate_contacts* contacts, const double* frictions) {
  if (!isThere(__func__, "contacts", contacts) || !isThere(__func__, "frictions", frictions))
    return PALPATE_INVALID_ARGUMENT;
  std::vector<Contact>& all = contacts->contacts;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (!(std::isfinite(frictions[n]) && frictions[n] >= 0))
      return fail(PALPATE_INVALID_ARGUMENT, "{}: friction {} is {}; it must be finite and >= 0",
                  __func__, n, frictions[n]);
  for (std::size_t n = 0; n < all.size(); ++n) all[n].setFriction(frictions[n]);
  return PALPATE_OK;
}

palpate_status palpate_contacts_update(palpate_contacts* contacts, const double* tools,
                                       const std::uint8_t* holds, const palpate_touches* touches) {
  if (!isThere(__func__, "contacts", contacts) || !isThere(__func__, "tools", tools) ||
      !sizeIsKnown(__func__, "touches", touches))
    return PALPATE_INVALID_ARGUMENT;
  const palpate_touches wanted = taken(touches, palpate_touches{});
  std::vector<Contact>& all = contacts->contacts;
  if (contacts->updates++ % updates_per_sort == 0) contacts->sort(tools);
  const auto update = [&](std::size_t part) {
    const std::size_t end = std::min(all.size(), (part + 1) * contacts_at_once);
    for (std::size_t place = part * contacts_at_once; place < end; ++place) {
      const std::size_t n = contacts->order[place].contact;
      giveTouch(wanted, n,
                all[n].update(vectorOf(tools + 3 * n), holds == nullptr || holds[n] != 0));
    }
  };
  contacts->threads.run((all.size() + contacts_at_once - 1) / contacts_at_once, std::ref(update));
  return PALPATE_OK;
}

palpate_status palpate_contacts_touch(const palpate_contacts* contacts, std::size_t index,
                                      palpate_touch* touch) {
  if (!isThere(__func__, "contacts", contacts) || !sizeIsKnown(__func__, "touch", touch))
    return PALPATE_INVALID_ARGUMENT;
  if (index >= contacts->contacts.size())
    return fail(PALPATE_INVALID_ARGUMENT, "{}: contact {} does not exist; there are {}", __func__,
                index, contacts->contacts.size());
  give(touch, toStruct(contacts->contacts[index].touch()));
  return PALPATE_OK;
}

palpate_status palpate_contacts_release(palpate_contacts* contacts, const std::uint8_t* mask) {
  if (!isThere(__func__, "contacts", contacts)) return PALPATE_INVALID_ARGUMENT;
  for (std::size_t n = 0; n < contacts->contacts.size(); ++n)
    if (mask == nullptr || mask[n] != 0) contacts->contacts[n].release();
  return PALPATE_OK;
}
