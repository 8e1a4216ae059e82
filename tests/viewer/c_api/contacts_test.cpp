#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "tests/support/finger_body.hpp"
#include "tests/viewer/c_api/counting_malloc.hpp"
#include "tests/viewer/c_api/sample_file.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

#define EXPECT_INVALID(call, text)             \
  EXPECT_EQ((call), PALPATE_INVALID_ARGUMENT); \
  EXPECT_THAT(palpate_last_error(), HasSubstr(text))

struct DestroyContacts {
  void operator()(palpate_contacts* contacts) const { palpate_contacts_destroy(contacts); }
};
using ContactsHandle = std::unique_ptr<palpate_contacts, DestroyContacts>;

ContactsHandle contactsOn(const palpate_dataset* dataset, std::size_t n, std::int32_t threads,
                          const palpate_contact_options* options = nullptr) {
  palpate_contacts* contacts = nullptr;
  EXPECT_EQ(palpate_contacts_create(dataset, options, n, threads, &contacts), PALPATE_OK)
      << palpate_last_error();
  return ContactsHandle(contacts);
}

/// All arrays of palpate_touches, for n contacts.
struct Arrays {
  explicit Arrays(std::size_t n)
      : touching(n),
        stepped(n),
        inside(n),
        triangles(n),
        forces(3 * n),
        stiffnesses(9 * n),
        energies(n),
        error_bounds(n),
        coverages(n),
        anchors(3 * n),
        normals(3 * n),
        displacements(3 * n),
        gaps(n),
        beyond(n),
        drives(3 * n) {}

  palpate_touches pointers() {
    return {sizeof(palpate_touches), touching.data(),  stepped.data(),     inside.data(),
            triangles.data(),        forces.data(),    stiffnesses.data(), energies.data(),
            error_bounds.data(),     coverages.data(), anchors.data(),     normals.data(),
            displacements.data(),    gaps.data(),      beyond.data(),      drives.data()};
  }
  /// Expects the values of contact n to be those of a touch, to the last bit.
  void expectIs(std::size_t n, const palpate_touch& touch) const {
    EXPECT_EQ(touching[n], touch.touching);
    EXPECT_EQ(stepped[n], touch.stepped);
    EXPECT_EQ(inside[n], touch.inside);
    EXPECT_EQ(triangles[n], touch.triangle);
    expectAre(forces, n, touch.force);
    expectAre(stiffnesses, n, touch.stiffness);
    expectAre(energies, n, {touch.energy});
    expectAre(error_bounds, n, {touch.error_bound});
    expectAre(coverages, n, {touch.coverage});
    expectAre(anchors, n, touch.anchor);
    expectAre(normals, n, touch.normal);
    expectAre(displacements, n, touch.displacement);
    expectAre(gaps, n, {touch.gap});
    expectAre(beyond, n, {touch.beyond});
    expectAre(drives, n, touch.drive);
  }

  std::vector<std::uint8_t> touching, stepped, inside;
  std::vector<std::int32_t> triangles;
  std::vector<double> forces, stiffnesses, energies, error_bounds, coverages, anchors, normals,
      displacements, gaps, beyond, drives;

 private:
  template <std::size_t size>
  static void expectAre(const std::vector<double>& array, std::size_t n,
                        const double (&values)[size]) {
    EXPECT_EQ(std::memcmp(array.data() + size * n, values, sizeof values), 0);
  }
};

/// The cube with two active nodes, and a cube whose top is touched by a finger.
class CContacts : public test::SharedSample {
 protected:
  static palpate_dataset* fingered() {
    static const test::DatasetHandle opened = [] {
      const test::TemporaryDirectory directory;
      test::FingerBody().seal(directory / "fingered.h5");
      return test::open(directory / "fingered.h5");
    }();
    return opened.get();
  }
};

/// Hands that press into the top of the cube and slide over it, each on its own way.
class Hands {
 public:
  explicit Hands(std::size_t n) : tools(3 * n) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share;
    for (std::size_t h = 0; h < n; ++h)
      hands_.push_back({0.03 + 0.04 * share(random), 0.03 + 0.04 * share(random),
                        0.003 + 0.004 * share(random), 6.3 * share(random)});
  }
  /// Sets `tools` to the positions at a phase; they are outside at whole numbers.
  void moveTo(double phase) {
    for (std::size_t h = 0; h < hands_.size(); ++h) {
      const auto& [x, y, depth, turn] = hands_[h];
      tools[3 * h] = x + 0.01 * std::sin(6.3 * phase + turn);
      tools[3 * h + 1] = y + 0.01 * std::cos(5 * phase + turn);
      tools[3 * h + 2] = 0.101 - depth * (1 - std::cos(6.3 * phase));
    }
  }

  std::vector<double> tools;

 private:
  struct Hand {
    double x, y, depth, turn;
  };
  std::vector<Hand> hands_;
};

TEST_F(CContacts, EqualSingleContactsToTheLastBitWithAnyNumberOfThreads) {
  constexpr std::size_t n = 150;
  for (const palpate_dataset* dataset : {shared(), fingered()})
    for (const std::int32_t threads : {1, 3, 0}) {
      const ContactsHandle contacts = contactsOn(dataset, n, threads);
      std::vector<double> frictions;
      std::vector<test::ContactHandle> single;
      for (std::size_t h = 0; h < n; ++h) {
        auto options = test::sized<palpate_contact_options>();
        ASSERT_EQ(palpate_contact_defaults(dataset, &options), PALPATE_OK);
        options.friction = 0.01 * static_cast<double>(h);
        frictions.push_back(options.friction);
        single.push_back(test::touchWith(dataset, &options));
      }
      ASSERT_EQ(palpate_contacts_set_frictions(contacts.get(), frictions.data()), PALPATE_OK);
      Hands hands(n);
      Arrays arrays(n);
      const palpate_touches touches = arrays.pointers();
      int touching = 0, slid = 0;
      std::vector<std::uint8_t> released(n);
      for (int tick = 0; tick < 150; ++tick) {
        hands.moveTo(0.01 * tick);
        if (tick == 40) hands.tools[3 * 5 + 1] = test::nan_value;
        if (tick == 60) {
          for (std::size_t h = 0; h < n; h += 7) released[h] = 1;
          ASSERT_EQ(palpate_contacts_release(contacts.get(), released.data()), PALPATE_OK);
          for (std::size_t h = 0; h < n; h += 7) palpate_contact_release(single[h].get());
        }
        ASSERT_EQ(palpate_contacts_update(contacts.get(), hands.tools.data(), nullptr, &touches),
                  PALPATE_OK);
        for (std::size_t h = 0; h < n; ++h) {
          auto touch = test::sized<palpate_touch>(), copy = touch;
          palpate_contact_update(single[h].get(), hands.tools.data() + 3 * h, 1, &touch);
          arrays.expectIs(h, touch);
          ASSERT_EQ(palpate_contacts_touch(contacts.get(), h, &copy), PALPATE_OK);
          EXPECT_TRUE(test::sameBits(copy, touch)) << h;
          touching += touch.touching;
          slid += touch.touching != 0 && touch.triangle != arrays.triangles[0] ? 1 : 0;
        }
        if (HasFailure()) FAIL() << "first in tick " << tick << " with " << threads << " threads";
      }
      EXPECT_GT(touching, 1000);
      EXPECT_GT(slid, 1000);
    }
}

TEST_F(CContacts, MarkAPositionThatIsNotFiniteAndGoOnWithTheOthers) {
  constexpr std::size_t n = 40;
  const ContactsHandle contacts = contactsOn(fingered(), n, 2);
  Hands hands(n);
  Arrays arrays(n);
  const palpate_touches touches = arrays.pointers();
  for (int tick = 0; tick <= 40; ++tick) {
    hands.moveTo(0.01 * tick);
    ASSERT_EQ(palpate_contacts_update(contacts.get(), hands.tools.data(), nullptr, &touches),
              PALPATE_OK);
  }
  ASSERT_THAT(arrays.touching, ::testing::Each(1));
  const Arrays before = arrays;
  hands.tools[3 * 3] = test::nan_value;
  hands.tools[3 * 4 + 2] = std::numeric_limits<double>::infinity();
  hands.tools[3 * 5 + 2] = 1e6;  // out of reach
  ASSERT_EQ(palpate_contacts_update(contacts.get(), hands.tools.data(), nullptr, &touches),
            PALPATE_OK);
  for (std::size_t h = 0; h < n; ++h) {
    const bool is_lost = h == 3 || h == 4;
    EXPECT_EQ(arrays.touching[h], is_lost || h == 5 ? 0 : 1) << h;
    EXPECT_EQ(arrays.inside[h], is_lost ? 0 : before.inside[h]) << h;
    EXPECT_EQ(arrays.stepped[h], is_lost ? 1 : 0) << h;
    EXPECT_TRUE(std::isfinite(arrays.forces[3 * h + 2])) << h;
  }
  EXPECT_NEAR(arrays.gaps[5], 1e6, 1);
}

TEST_F(CContacts, GiveTheDriveOfTheAreaAtTheAnchor) {
  const ContactsHandle contacts = contactsOn(fingered(), 1, 1);
  Hands hands(1);
  Arrays arrays(1);
  const palpate_touches touches = arrays.pointers();
  for (int tick = 0; tick <= 40; ++tick) {
    hands.moveTo(0.01 * tick);
    ASSERT_EQ(palpate_contacts_update(contacts.get(), hands.tools.data(), nullptr, &touches),
              PALPATE_OK);
  }
  ASSERT_EQ(arrays.touching[0], 1);
  auto sample = test::sized<palpate_area_sample>();
  ASSERT_EQ(palpate_area_query(fingered(), 0, arrays.anchors.data(), arrays.displacements.data(),
                               &sample),
            PALPATE_OK);
  EXPECT_GT(Eigen::Vector3d(sample.drive).norm(), 1e-6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(arrays.drives[i], sample.drive[i], 1e-9);
}

TEST_F(CContacts, LetGoOneByOneWhenGlued) {
  auto options = test::sized<palpate_contact_options>();
  ASSERT_EQ(palpate_contact_defaults(shared(), &options), PALPATE_OK);
  options.mode = PALPATE_GLUED;
  const ContactsHandle contacts = contactsOn(shared(), 2, 1, &options);
  std::vector<double> tools;
  for (int n = 0; n < 2; ++n)
    for (const double x : test::pressing(shared(), 1, 4)) tools.push_back(x);
  std::vector<std::uint8_t> touching(2);
  auto touches = test::sized<palpate_touches>();
  touches.touching = touching.data();
  ASSERT_EQ(palpate_contacts_update(contacts.get(), tools.data(), nullptr, &touches), PALPATE_OK);
  EXPECT_THAT(touching, ::testing::ElementsAre(1, 1));
  const std::vector<std::uint8_t> holds = {0, 1};
  ASSERT_EQ(palpate_contacts_update(contacts.get(), tools.data(), holds.data(), &touches),
            PALPATE_OK);
  EXPECT_THAT(touching, ::testing::ElementsAre(0, 1));
}

TEST_F(CContacts, DoNotAllocateWhileTheyAreUpdated) {
  if (test::allocationCount() < 0) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  constexpr std::size_t n = 40;
  const ContactsHandle contacts = contactsOn(fingered(), n, 2);
  Hands hands(n);
  Arrays arrays(n);
  const palpate_touches touches = arrays.pointers();
  const long before = test::allocationCount();
  int failures = 0;
  for (int tick = 0; tick < 100; ++tick) {
    hands.moveTo(0.01 * tick);
    failures +=
        palpate_contacts_update(contacts.get(), hands.tools.data(), nullptr, &touches) == PALPATE_OK
            ? 0
            : 1;
  }
  failures += palpate_contacts_release(contacts.get(), nullptr) == PALPATE_OK ? 0 : 1;
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(failures, 0);
}

TEST_F(CContacts, RefuseInvalidArguments) {
  palpate_contacts* none = nullptr;
  EXPECT_INVALID(palpate_contacts_create(nullptr, nullptr, 1, 1, &none), "dataset is NULL");
  EXPECT_INVALID(palpate_contacts_create(shared(), nullptr, 1, 1, nullptr), "contacts is NULL");
  EXPECT_INVALID(palpate_contacts_create(shared(), nullptr, 1, -1, &none), "threads is -1");
  auto options = test::sized<palpate_contact_options>();
  ASSERT_EQ(palpate_contact_defaults(shared(), &options), PALPATE_OK);
  options.friction = -1;
  EXPECT_INVALID(palpate_contacts_create(shared(), &options, 1, 1, &none), "friction is -1");
  EXPECT_EQ(none, nullptr);

  const ContactsHandle contacts = contactsOn(shared(), 2, 1);
  const double tools[6] = {}, frictions[2] = {0.5, test::nan_value};
  auto touches = test::sized<palpate_touches>();
  auto touch = test::sized<palpate_touch>();
  EXPECT_INVALID(palpate_contacts_update(nullptr, tools, nullptr, &touches), "contacts is NULL");
  EXPECT_INVALID(palpate_contacts_update(contacts.get(), nullptr, nullptr, &touches),
                 "tools is NULL");
  EXPECT_INVALID(palpate_contacts_update(contacts.get(), tools, nullptr, nullptr),
                 "touches is NULL");
  touches.size = 8;
  EXPECT_INVALID(palpate_contacts_update(contacts.get(), tools, nullptr, &touches),
                 "touches->size is 8");
  EXPECT_INVALID(palpate_contacts_set_frictions(contacts.get(), frictions), "friction 1 is nan");
  EXPECT_INVALID(palpate_contacts_set_frictions(contacts.get(), nullptr), "frictions is NULL");
  EXPECT_INVALID(palpate_contacts_touch(contacts.get(), 2, &touch), "contact 2 does not exist");
  EXPECT_INVALID(palpate_contacts_release(nullptr, nullptr), "contacts is NULL");
  palpate_contacts_destroy(nullptr);
  const ContactsHandle empty = contactsOn(shared(), 0, 0);
  touches.size = sizeof touches;
  EXPECT_EQ(palpate_contacts_update(empty.get(), tools, nullptr, &touches), PALPATE_OK);
}

}  // namespace
}  // namespace palpate
