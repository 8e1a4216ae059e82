#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <vector>

#include "common/base/machine.hpp"
#include "common/base/thread_pool.hpp"
#include "viewer/c_api/live_scene.hpp"
#include "viewer/c_api/touch_struct.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/deformed_shape.hpp"

using namespace palpate;

namespace {

/// A live solver in use by one contact.
class UsedLive {
 public:
  /// `live`: may be null. Refuses a live solver of another dataset and one that is in use.
  UsedLive(const char* name, const palpate_live* live, const LoadedDataset& dataset) {
    if (live == nullptr) return;
    if (live->scene->loaded.get() != &dataset)
      refuse("{} belongs to another dataset; use palpate_live_dataset", name);
    if (live->scene->in_use.exchange(true))
      refuse("another contact uses {}; destroy it first", name);
    scene_ = live->scene;
  }
  ~UsedLive() {
    if (scene_) scene_->in_use = false;
  }
  UsedLive(const UsedLive&) = delete;
  UsedLive& operator=(const UsedLive&) = delete;

  void correct(Contact& contact) const {
    if (scene_) contact.correctBy(&scene_->touch, &scene_->loaded->model, scene_->period);
  }

 private:
  std::shared_ptr<LiveScene> scene_;
};

}  // namespace

struct palpate_contact {
  palpate_contact(const palpate_dataset& dataset, const ContactOptions& options, std::size_t method,
                  const palpate_live* live)
      : loaded(dataset.loaded),
        used("options->live", live, *loaded),
        contact(loaded->model, options) {
    contact.use(loaded->model, method);
    used.correct(contact);
  }

  std::shared_ptr<const LoadedDataset> loaded;
  const UsedLive used;
  Contact contact;
};

struct palpate_contacts {
  palpate_contacts(const palpate_dataset& dataset, const ContactOptions& options,
                   std::size_t method, std::size_t n, std::size_t n_threads)
      : loaded(dataset.loaded),
        contacts(n, Contact(loaded->model, options)),
        order(n),
        threads(n_threads) {
    for (Contact& contact : contacts) contact.use(loaded->model, method);
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
  std::map<std::size_t, UsedLive> lives;  ///< of some of the contacts
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

/// Options of a contact, as the library needs them.
struct Chosen {
  Chosen(const palpate_contact_options* options, const palpate_dataset& dataset) {
    const Given given = takenOptions(options, defaultsFor(dataset));
    if (given.mode != PALPATE_UNILATERAL && given.mode != PALPATE_GLUED)
      refuse("options->mode is {}; it must be PALPATE_UNILATERAL or PALPATE_GLUED", given.mode);
    contact.mode = given.mode == PALPATE_GLUED ? ContactMode::glued : ContactMode::unilateral;
    live = given.live;
    takeOver(given, contact, numbers);
    method = indexOf("method", given.method, dataset.loaded->model.methods().size());
  }

  ContactOptions contact;
  std::size_t method = 0;
  const palpate_live* live = nullptr;  ///< null: no live solver
};

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

/// Refuses a touch whose triangle or spaces do not exist in a dataset; the caller may have filled
/// in the touch by hand.
void checkBelongs(const palpate_touch& touch, const LoadedDataset& dataset) {
  // The other members of a touch without contact are not read.
  if (touch.touching == 0) return;
  indexOf("triangle", touch.triangle, dataset.model.surface().triangles().size());
  if (touch.share_count < 1 || touch.share_count > PALPATE_MOST_SHARES)
    refuse("touch->share_count is {}; it must be from 1 to {}", touch.share_count,
           PALPATE_MOST_SHARES);
  for (std::int32_t s = 0; s < touch.share_count; ++s)
    indexOf("space", touch.share_spaces[s], dataset.spaces.size());
}

}  // namespace

palpate_status palpate_contact_defaults(const palpate_dataset* dataset,
                                        palpate_contact_options* options) {
  return answered(__func__,
                  [&] { give("options", options, defaultsFor(need("dataset", dataset))); });
}

palpate_status palpate_contact_create(const palpate_dataset* dataset,
                                      const palpate_contact_options* options,
                                      palpate_contact** contact) {
  return answered(__func__, [&] {
    need("contact", contact) = nullptr;
    const Chosen chosen(options, need("dataset", dataset));
    *contact = new palpate_contact(*dataset, chosen.contact, chosen.method, chosen.live);
  });
}

void palpate_contact_destroy(palpate_contact* contact) { delete contact; }

palpate_status palpate_contact_update(palpate_contact* contact, const double tool[3],
                                      std::int32_t hold, palpate_touch* touch) {
  return answered(__func__, [&] {
    Contact& updated = need("contact", contact).contact;
    const Eigen::Vector3d position = vectorOf("tool", tool);
    needSize("touch", touch);  // before the update, which cannot be undone
    give("touch", touch, toStruct(updated.update(position, hold != 0)));
  });
}

palpate_status palpate_contact_release(palpate_contact* contact) {
  return answered(__func__, [&] { need("contact", contact).contact.release(); });
}

palpate_status palpate_contact_use(palpate_contact* contact, const palpate_dataset* dataset,
                                   std::int32_t method) {
  return answered(__func__, [&] {
    palpate_contact& user = need("contact", contact);
    const std::size_t methods = loadedOf(dataset).model.methods().size();
    const std::size_t chosen = indexOf("method", method, methods);
    // use() compares the two models, so the previous model must stay alive until use() returns.
    const std::shared_ptr<const LoadedDataset> former = user.loaded;
    user.loaded = dataset->loaded;
    user.contact.use(user.loaded->model, chosen);
  });
}

palpate_status palpate_touch_displacements(const palpate_dataset* dataset,
                                           const palpate_touch* touch, float* displacements,
                                           std::size_t capacity) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    const palpate_touch known = taken("touch", touch, toStruct(Touch{}));
    const std::size_t vertices = loaded.model.surface().vertices().size();
    const auto filled = roomIn("displacements", displacements, capacity, 3 * vertices);
    checkBelongs(known, loaded);
    DeformedShape(vertices).evaluate(loaded.model, toTouch(known), filled);
  });
}

palpate_status palpate_contacts_create(const palpate_dataset* dataset,
                                       const palpate_contact_options* options, std::size_t n,
                                       std::int32_t threads, palpate_contacts** contacts) {
  return answered(__func__, [&] {
    need("contacts", contacts) = nullptr;
    const Chosen chosen(options, need("dataset", dataset));
    if (chosen.live != nullptr)
      refuse("options->live must be NULL; use palpate_contacts_follow for each live solver");
    if (n > most_contacts) refuse("n is {}; it must be at most {}", n, most_contacts);
    if (threads < 0 || threads > most_threads)
      refuse("threads is {}; it must be from 0 to {}", threads, most_threads);
    *contacts = new palpate_contacts(*dataset, chosen.contact, chosen.method, n,
                                     threads == 0 ? coreCount() : at(threads));
  });
}

void palpate_contacts_destroy(palpate_contacts* contacts) { delete contacts; }

palpate_status palpate_contacts_follow(palpate_contacts* contacts, std::size_t index,
                                       const palpate_live* live) {
  return answered(__func__, [&] {
    palpate_contacts& all = need("contacts", contacts);
    if (index >= all.contacts.size())
      refuse("contact {} does not exist; there are {}", index, all.contacts.size());
    all.contacts[index].correctBy(nullptr, nullptr, 0);
    all.lives.erase(index);
    if (live == nullptr) return;
    all.lives.try_emplace(index, "live", live, *all.loaded)
        .first->second.correct(all.contacts[index]);
  });
}

palpate_status palpate_contacts_set_frictions(palpate_contacts* contacts, const double* frictions) {
  return answered(__func__, [&] {
    std::vector<Contact>& all = need("contacts", contacts).contacts;
    need("frictions", frictions);
    for (std::size_t n = 0; n < all.size(); ++n)
      if (!(std::isfinite(frictions[n]) && frictions[n] >= 0))
        refuse("friction {} is {}; it must be finite and >= 0", n, frictions[n]);
    for (std::size_t n = 0; n < all.size(); ++n) all[n].setFriction(frictions[n]);
  });
}

palpate_status palpate_contacts_update(palpate_contacts* contacts, const double* tools,
                                       const std::uint8_t* holds, const palpate_touches* touches) {
  return answered(__func__, [&] {
    std::vector<Contact>& all = need("contacts", contacts).contacts;
    need("tools", tools);
    const palpate_touches wanted = taken("touches", touches, palpate_touches{});
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
  });
}

palpate_status palpate_contacts_touch(const palpate_contacts* contacts, std::size_t index,
                                      palpate_touch* touch) {
  return answered(__func__, [&] {
    const std::vector<Contact>& all = need("contacts", contacts).contacts;
    if (index >= all.size()) refuse("contact {} does not exist; there are {}", index, all.size());
    give("touch", touch, toStruct(all[index].touch()));
  });
}

palpate_status palpate_contacts_release(palpate_contacts* contacts, const std::uint8_t* mask) {
  return answered(__func__, [&] {
    std::vector<Contact>& all = need("contacts", contacts).contacts;
    for (std::size_t n = 0; n < all.size(); ++n)
      if (mask == nullptr || mask[n] != 0) all[n].release();
  });
}
