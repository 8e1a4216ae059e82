// A haptic loop at its rate, with a scripted hand that presses and slides over the whole touchable
// surface; with --busy beside a thread that is as busy as the picture: it computes the deformed
// shape of the whole surface 60 times a second. Prints one JSON object. Checks nothing, because
// times depend on the machine.
//
//   palpate_haptic_loop_bench DATASET [SECONDS] [RATE] [--busy] [--real-time]

#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "common/base/error.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/haptics/haptic_loop.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

/// A guided hand that spends half a second at each touchable triangle in turn: it approaches along
/// the normal and presses to a quarter of the workspace radius, in a circle as wide as the
/// triangle.
class SweepingHand : public HapticDevice {
 public:
  SweepingHand(const HapticModel& model, double period) : model_(model), period_(period) {
    for (std::size_t t = 0; t < model.surface().triangles().size(); ++t)
      if (model.surface().touchable(static_cast<std::int32_t>(t)))
        triangles_.push_back(static_cast<std::int32_t>(t));
    depth_ = 0.25 * model.spaces().front().lattice.radius();
  }
  DeviceReading read() noexcept override {
    const double time = period_ * static_cast<double>(++ticks_), turn = 2 * std::numbers::pi;
    const auto visit = static_cast<std::size_t>(time / visit_s);
    const double share = time / visit_s - static_cast<double>(visit);
    const std::int32_t triangle = triangles_[visit % triangles_.size()];
    const TouchSurface& surface = model_.surface();
    const auto& corners = surface.triangles()[static_cast<std::size_t>(triangle)];
    const SurfacePoint middle = {triangle, Eigen::Vector3d::Constant(1.0 / 3)};
    const Eigen::Vector3d center = surface.position(middle), normal = surface.normal(middle);
    const Eigen::Vector3d along =
        (surface.vertices()[static_cast<std::size_t>(corners[0])] - center).cross(normal);
    const Eigen::Vector3d circle =
        std::cos(turn * 3 * share) * along + std::sin(turn * 3 * share) * normal.cross(along);
    const double height = 0.003 - (0.003 + depth_) * 0.5 * (1 - std::cos(turn * share));
    return {center + height * normal + 0.7 * circle, 0, DeviceStatus::fresh};
  }
  void write(const Eigen::Vector3d&) noexcept override {}
  void halt() noexcept override {}
  void resume() noexcept override {}
  DeviceProfile profile() const override { return {"omega", 12, 5000, 0.075}; }
  bool livesInScene() const override { return true; }
  std::string name() const override { return "sweeping hand"; }

 private:
  static constexpr double visit_s = 0.5;
  const HapticModel& model_;
  double period_;
  std::vector<std::int32_t> triangles_;
  double depth_ = 0;
  std::uint64_t ticks_ = 0;
};

/// The load of the picture on the haptic thread and on a core.
void drawShapes(HapticLoop& loop, const HapticModel& model, std::atomic<std::uint64_t>& frames) {
  using namespace std::chrono_literals;
  const std::size_t vertices = model.surface().vertices().size();
  DeformedShape shape(vertices);
  std::vector<float> out(3 * vertices);
  for (auto due = std::chrono::steady_clock::now(); loop.running(); due += 16667us) {
    shape.evaluate(model, loop.latest().touch, out);
    ++frames;
    std::this_thread::sleep_until(due);
  }
}

struct Arguments {
  std::string dataset;
  double seconds = 10, rate = 1000;
  bool busy = false, real_time = false;
};

double numberIn(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value > 0))
    throw badInput("{}: is not a positive number", word);
  return value;
}

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  std::vector<std::string> plain;
  for (const std::string& word : words) {
    if (word == "--busy")
      arguments.busy = true;
    else if (word == "--real-time")
      arguments.real_time = true;
    else
      plain.push_back(word);
  }
  if (plain.empty() || plain.size() > 3)
    throw badInput(
        "usage: palpate_haptic_loop_bench DATASET [SECONDS] [RATE] [--busy] [--real-time]\n"
        "--busy: a thread deforms the surface 60 times a second.\n"
        "--real-time: SCHED_FIFO and locked memory; trouble lists the requests that the\n"
        "  system refused.\n"
        "A histogram is a list of pairs of upper edge, us, and count. compute_us: wall time\n"
        "  of a tick.\n"
        "missed_program: deadlines missed because the tick computed too long; missed_system:\n"
        "  all others");
  arguments.dataset = plain[0];
  if (plain.size() > 1) arguments.seconds = numberIn(plain[1]);
  if (plain.size() > 2) arguments.rate = numberIn(plain[2]);
  return arguments;
}

int runBenchmark(const std::vector<std::string>& words) {
  const Arguments arguments = parse(words);
  const HapticModel model{Dataset(arguments.dataset)};
  TickOptions tick_options;
  tick_options.period = 1 / arguments.rate;
  SweepingHand hand(model, tick_options.period);
  tick_options.guard = guardFor(hand.profile(), tick_options.period);
  HapticTick tick({&model}, hand, tick_options);
  LoopOptions options;
  options.rate = arguments.rate;
  options.real_time = arguments.real_time;
  options.ticks = static_cast<std::uint64_t>(arguments.seconds * arguments.rate);
  HapticLoop loop(tick, hand, options);

  std::atomic<std::uint64_t> frames = 0;
  loop.start();
  std::thread picture;
  if (arguments.busy) picture = std::thread([&] { drawShapes(loop, model, frames); });
  while (loop.running()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  if (picture.joinable()) picture.join();
  loop.stop();

  Json answer = Json::parse(describeJson(loop.statistics()));
  answer["spaces"] = model.spaces().size();
  answer["surface_vertices"] = model.surface().vertices().size();
  answer["surface_triangles"] = model.surface().triangles().size();
  answer["frames"] = frames.load();
  answer["trouble"] = loop.trouble();
  std::cout << answer.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::runBenchmark({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate_haptic_loop_bench: {}\n", error.what());
    return 1;
  }
}
