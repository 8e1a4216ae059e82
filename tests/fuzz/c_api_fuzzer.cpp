#include <cmath>
#include <limits>
#include <memory>

#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/c_api/palpate.h"

namespace palpate::fuzz {
namespace {

/// Calls of a simulator, chosen by their first byte.
enum ApiCall : unsigned char {
  describes,
  queries,
  asks_for_shape,
  creates_contact,
  updates_contact,
  switches_method,
  draws_touch,  ///< a touch composed by the caller
  asks_for_area,
  creates_guard,
  limits_force,
  opens_file,
  switches_dataset,  ///< to the other of two datasets: active nodes, or an area
  api_calls
};

/// Checks what the documentation promises for every call.
palpate_status answered(palpate_status status) {
  require(status == PALPATE_OK || status == PALPATE_INVALID_ARGUMENT || status == PALPATE_BAD_FILE,
          palpate_last_error());
  return status;
}

template <std::size_t n>
bool allFinite(const double (&values)[n]) {
  for (const double value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

/// An input structure with any content; its size is usually right.
template <class Struct>
Struct given(Choices& choices) {
  auto value = choices.take<Struct>();
  if (choices.oneOf(8) != 0) value.size = sizeof value;
  return value;
}

/// An output structure; its size is usually right.
template <class Struct>
Struct toBeFilled(Choices& choices) {
  Struct value{};
  value.size = choices.oneOf(8) != 0 ? sizeof value : choices.take<std::uint16_t>();
  return value;
}

/// Tools and displacements, mostly within the size of the body.
std::array<double, 3> place(Choices& choices) {
  if (choices.oneOf(4) == 0) return choices.take<std::array<double, 3>>();
  std::array<double, 3> x{};
  for (double& component : x) component = 1e-5 * choices.take<std::int16_t>();
  return x;
}

class Simulator {
 public:
  ~Simulator() {
    palpate_contact_destroy(contact_);
    palpate_guard_destroy(guard_);
  }

  void follow(Choices& choices) {
    switch (choices.oneOf(api_calls)) {
      case describes: return describe(choices);
      case queries: return query(choices);
      case asks_for_shape: return askForShape(choices);
      case creates_contact: return createContact(choices);
      case updates_contact: return updateContact(choices);
      case switches_method:
        answered(palpate_contact_use(contact_, dataset(), choices.take<std::int32_t>()));
        return;
      case draws_touch: return drawTouch(choices);
      case asks_for_area: return askForArea(choices);
      case creates_guard: return createGuard(choices);
      case limits_force: return limitForce(choices);
      case opens_file: return openFile(choices);
      case switches_dataset: with_area_ = !with_area_; return;
      default: return;
    }
  }

  static void openDatasets() {
    ofNodes();
    ofArea();
  }

 private:
  using Handle = std::unique_ptr<palpate_dataset, void (*)(palpate_dataset*)>;

  template <class Body>
  static Handle open(const Body& body) {
    const test::TemporaryDirectory directory;
    body.seal(directory / "body.h5");
    palpate_dataset* made = nullptr;
    require(palpate_dataset_open((directory / "body.h5").c_str(), nullptr, &made) == PALPATE_OK,
            palpate_last_error());
    return {made, palpate_dataset_close};
  }
  static palpate_dataset* ofNodes() {
    static const Handle opened = open(test::SampleDataset());
    return opened.get();
  }
  static palpate_dataset* ofArea() {
    static const Handle opened = open(test::FingerBody());
    return opened.get();
  }
  palpate_dataset* dataset() const { return with_area_ ? ofArea() : ofNodes(); }
  std::size_t vertexNumbers() const {
    palpate_dataset_info info{};
    info.size = sizeof info;
    require(palpate_dataset_describe(dataset(), &info) == PALPATE_OK, palpate_last_error());
    return 3 * static_cast<std::size_t>(info.vertex_count);
  }

  void describe(Choices& choices) {
    auto info = toBeFilled<palpate_dataset_info>(choices);
    answered(palpate_dataset_describe(dataset(), &info));
    auto space = toBeFilled<palpate_space_info>(choices);
    answered(palpate_dataset_space(dataset(), choices.take<std::int32_t>(), &space));
    palpate_dataset_method(dataset(), choices.take<std::int32_t>());
    const std::string name(choices.takeBytes());
    std::int32_t number = 0;
    answered(palpate_dataset_find_space(dataset(), name.c_str(), &number));
    answered(palpate_dataset_find_method(dataset(), name.c_str(), &number));
    answered(palpate_dataset_find_area(dataset(), name.c_str(), &number));
    auto profile = toBeFilled<palpate_profile>(choices);
    answered(palpate_device_profile(name.c_str(), &profile));
    // The buffer is never larger than its stated size.
    std::vector<double> numbers(8 * choices.oneOf(200));
    answered(palpate_dataset_vertices(dataset(), numbers.data(), numbers.size()));
    std::vector<std::int32_t> triangles(8 * choices.oneOf(200));
    answered(palpate_dataset_triangles(dataset(), triangles.data(), triangles.size()));
    std::vector<std::uint8_t> touchable(8 * choices.oneOf(200));
    answered(palpate_dataset_touchable(dataset(), touchable.data(), touchable.size()));
  }

  void query(Choices& choices) {
    const auto p = place(choices);
    const auto space = static_cast<std::int32_t>(choices.take<std::int8_t>()),
               method = static_cast<std::int32_t>(choices.take<std::int8_t>());
    auto sample = toBeFilled<palpate_sample>(choices);
    if (answered(palpate_query(dataset(), space, method, p.data(), &sample)) == PALPATE_OK)
      require(allFinite(sample.force) && allFinite(sample.stiffness), "a force is not finite");
    std::array<double, 3> force{};
    auto answers = toBeFilled<palpate_answers>(choices);
    answers.forces = force.data();
    answered(palpate_query_many(dataset(), space, method, p.data(), 1, &answers));
  }

  void askForShape(Choices& choices) {
    const auto p = place(choices);
    std::vector<float> shape(8 * choices.oneOf(200));
    std::int32_t inside = 0;
    answered(palpate_displacements(dataset(), choices.take<std::int8_t>(), p.data(), shape.data(),
                                   shape.size(), &inside));
  }

  void createContact(Choices& choices) {
    palpate_contact_destroy(contact_);
    auto options = toBeFilled<palpate_contact_options>(choices);
    answered(palpate_contact_defaults(dataset(), &options));
    if (choices.oneOf(2) == 0) options = given<palpate_contact_options>(choices);
    answered(palpate_contact_create(dataset(), &options, &contact_));
  }

  void updateContact(Choices& choices) {
    const auto tool = place(choices);
    const std::int32_t hold = choices.take<std::int8_t>();
    auto touch = toBeFilled<palpate_touch>(choices);
    if (answered(palpate_contact_update(contact_, tool.data(), hold, &touch)) != PALPATE_OK) return;
    require(allFinite(touch.force) && allFinite(touch.stiffness), "a touch is not finite");
    touch_ = touch;
    std::vector<float> shape(vertexNumbers());
    answered(palpate_touch_displacements(dataset(), &touch, shape.data(), shape.size()));
    if (choices.oneOf(16) == 0) answered(palpate_contact_release(contact_));
  }

  void drawTouch(Choices& choices) {
    const auto touch = given<palpate_touch>(choices);
    std::vector<float> shape(vertexNumbers());
    answered(palpate_touch_displacements(dataset(), &touch, shape.data(), shape.size()));
  }

  void askForArea(Choices& choices) {
    std::int32_t count = 0;
    answered(palpate_dataset_area_count(dataset(), &count));
    auto info = toBeFilled<palpate_area_info>(choices);
    answered(palpate_dataset_area(dataset(), choices.take<std::int8_t>(), &info));
    const auto at = place(choices), p = place(choices);
    auto sample = toBeFilled<palpate_area_sample>(choices);
    const std::int32_t area = choices.take<std::int8_t>();
    answered(palpate_area_query(dataset(), area, at.data(), p.data(), &sample));
    std::array<double, 3> drive{};
    auto answers = toBeFilled<palpate_answers>(choices);
    answers.drives = drive.data();
    answered(palpate_area_query_many(dataset(), area, at.data(), p.data(), 1, &answers));
  }

  void createGuard(Choices& choices) {
    palpate_guard_destroy(guard_);
    guard_ = nullptr;
    auto options = toBeFilled<palpate_guard_options>(choices);
    const std::string device(choices.takeBytes());
    answered(palpate_guard_defaults(device.empty() ? nullptr : device.c_str(),
                                    choices.take<double>(), &options));
    if (choices.oneOf(2) == 0) options = given<palpate_guard_options>(choices);
    answered(palpate_guard_create(choices.oneOf(4) == 0 ? nullptr : &options, &guard_));
  }

  void limitForce(Choices& choices) {
    if (guard_ == nullptr) answered(palpate_guard_create(nullptr, &guard_));
    const auto tool = place(choices);
    const auto touch = choices.oneOf(2) == 0 ? given<palpate_touch>(choices) : touch_;
    const auto flags = choices.oneOf(8) == 0 ? choices.take<std::uint32_t>() : 1u;
    auto guarded = toBeFilled<palpate_guarded_force>(choices);
    answered(palpate_guard_limit(guard_, tool.data(), &touch, flags, &guarded));
    require(allFinite(guarded.force), "a guarded force is not finite");
    if (choices.oneOf(16) == 0) answered(palpate_guard_reset(guard_));
  }

  static void openFile(Choices& choices) {
    const std::string name(choices.takeBytes()), method(choices.takeBytes());
    const char* const methods[] = {method.c_str()};
    auto options = toBeFilled<palpate_open_options>(choices);
    options.methods = methods;
    options.method_count = choices.oneOf(2);
    options.reach = choices.take<double>();
    palpate_dataset* other = nullptr;
    answered(palpate_dataset_open(("/nowhere/" + name).c_str(), &options, &other));
    palpate_dataset_close(other);
  }

  bool with_area_ = false;
  palpate_contact* contact_ = nullptr;
  palpate_guard* guard_ = nullptr;
  palpate_touch touch_ = [] {
    palpate_touch touch{};
    touch.size = sizeof touch;
    return touch;
  }();
};

void callApi(std::string_view bytes) {
  Choices choices(bytes);
  Simulator simulator;
  while (!choices.done()) simulator.follow(choices);
}

std::vector<std::string> apiSeeds() {
  Script press, look;
  // The bytes in between select sizes, modes and flags.
  press.op(creates_contact).op(1).op(1);
  for (std::int16_t depth = 0; depth < 8; ++depth) {
    press.op(updates_contact).op(1).put(static_cast<std::int16_t>(10100 - 200 * depth));
    press.put(std::int16_t{8800}).put(std::int16_t{9200}).op(1).op(1).op(1);
    press.op(limits_force).op(1).put(std::array<std::int16_t, 3>{10000, 8800, 9200}).op(1).op(1);
    press.op(1).op(1);
  }
  look.op(queries).op(1).put(std::array<std::int16_t, 3>{100, -200, 300}).op(0).op(1).op(1);
  look.op(asks_for_shape).op(1).put(std::array<std::int16_t, 3>{100, 0, 0}).op(100).op(1);
  look.op(describes).op(1).op(1).put(std::int32_t{1}).put(std::int32_t{0}).putBytes("tip").op(1);
  look.op(150).op(150).op(100);
  Script area;
  area.op(switches_dataset).op(asks_for_area).op(1).put(std::int8_t{0}).op(1);
  area.put(std::array<std::int16_t, 3>{4300, 5500, 12000}).op(1);
  area.put(std::array<std::int16_t, 3>{200, -100, -900}).op(1).put(std::int8_t{0});
  Script far;
  far.op(switches_dataset).op(asks_for_area).op(1).put(std::int8_t{0}).op(0);
  far.put(std::array<double, 3>{0, 1e200, 0}).op(1).put(std::array<std::int16_t, 3>{0, 0, -900});
  return {press.text(), look.text(), area.text() + press.text(), far.text()};
}

const Registration c_api_fuzzer({"c_api", callApi, apiSeeds, Simulator::openDatasets});

}  // namespace
}  // namespace palpate::fuzz
