// Processor time of one frame with a surface of 5,292 triangles, drawn as they are, and with one of
// 972, drawn rounded like organs. It covers this whole process with its software rendering threads
// (getrusage), in the default window on a separate Xvfb, but not the X server's own share, which
// copies the frame. Prints one JSON object. Checks nothing, because times depend on the machine.
//
//   picture_bench [PICTURES]

#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/viewer/haptics/touched_model.hpp"
#include "tests/viewer/picture/virtual_screen.hpp"
#include "viewer/picture/picture.hpp"

namespace palpate {
namespace {

constexpr double depth = 0.015;  // m

double processorSeconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

/// cells: along an edge of the original cube.
HapticModel blob(int cells) {
  const Mesh mesh = test::blobMesh(cells);
  const std::vector<std::int32_t>& top = mesh.node_groups.at("zmax");
  const auto distance = [&](std::int32_t node) {
    return mesh.nodes[static_cast<std::size_t>(node)].head<2>().norm();
  };
  return test::modelOf({mesh, {{*std::ranges::min_element(top, {}, distance), 1}}}, 0.06);
}

/// A hand that presses in and out once a second.
class Hand {
 public:
  explicit Hand(const HapticModel& model)
      : contact_(model), top_(model.surface().tree().nearest({0, 0, 0.2}).position.z()) {}
  const HapticState& next() {
    state_.time += 1.0 / 60;
    const double z = top_ + 0.002 - depth * std::pow(std::sin(3.14159 * state_.time), 2);
    state_.tool = {0, 0, z};
    state_.touch = contact_.update(state_.tool);
    state_.force = state_.touch.force;
    return state_;
  }

 private:
  Contact contact_;
  double top_;
  HapticState state_;
};

nlohmann::json measure(const HapticModel& model, PictureOptions options, int pictures) {
  options.vsync = false;
  Picture picture({&model}, options);
  Hand hand(model);
  for (int n = 0; n < 60; ++n) picture.draw(hand.next(), {});
  const double begin = processorSeconds();
  for (int n = 0; n < pictures; ++n) picture.draw(hand.next(), {});
  return {{"processor_ms", 1e3 / pictures * (processorSeconds() - begin)}};
}

nlohmann::json measureBlob(int cells, int pictures) {
  const HapticModel model = blob(cells);
  return {{"triangles", model.surface().triangles().size()},
          {"usual", measure(model, {}, pictures)},
          {"without_ghost", measure(model, {.ghost = false}, pictures)},
          {"with_lattice", measure(model, {.lattice = true}, pictures)}};
}

int run(int pictures) {
  const test::VirtualScreen screen;
  const PictureOptions usual;
  const nlohmann::json out = {{"window", {usual.width, usual.height}},
                              {"pictures", pictures},
                              {"as_it_is", measureBlob(21, pictures)},
                              {"rounded", measureBlob(9, pictures)}};
  std::puts(out.dump(2).c_str());
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc > 1 ? std::atoi(argv[1]) : 600);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
