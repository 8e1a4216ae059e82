#include "viewer/view_command.hpp"

#include <iostream>

#include "common/base/required_option.hpp"
#include "viewer/devices/device_choice.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

constexpr double most_ticks_per_second = 10000;

/// Checks the options. Call it before anything is opened, because another problem could hide a
/// wrong option.
void check(const ViewOptions& options) {
  checkDeviceWord(options.device);
  if (!(options.rate >= 100 && options.rate <= most_ticks_per_second))
    throw badInput("--rate {}: give 100 to {} ticks per second", options.rate,
                   most_ticks_per_second);
  if (!(options.friction >= 0 && options.friction <= 10))
    throw badInput("--friction {}: give a number from 0 to 10", options.friction);
  if (!(options.reach >= 0)) throw badInput("--reach {}: give 0 or more metres", options.reach);
  if (!(options.hand_speed > 0 && options.hand_speed <= 10))
    throw badInput("--hand-speed {}: give a speed above 0 and at most 10 m/s", options.hand_speed);
  if (!(options.duration >= 0))
    throw badInput("--duration {}: give 0 or more seconds", options.duration);
  if (options.fast && options.duration <= 0 && !options.device.starts_with("replay"))
    throw badInput("--fast runs without a clock: give the length of the run with --duration");
  if (options.fast &&
      !(options.device.starts_with("virtual") || options.device.starts_with("replay")))
    throw badInput("--fast works only with the virtual hand and replays; {} runs in real time",
                   options.device);
  const bool is_scene = options.datasets.front().extension() == ".toml";
  const bool follows = !options.live.empty() || is_scene;
  if (!options.build.empty() && !is_scene)
    throw badInput("--build {}: give the scene, SCENE.toml, instead of {}", options.build.string(),
                   options.datasets.front().string());
  if (!options.follower.empty() && !follows)
    throw badInput("--follower {}: give the scene too, with --live", options.follower);
  if (!options.hold.empty() && !follows)
    throw badInput("--hold {}: a second finger needs live solving: add --live SCENE",
                   options.hold.string());
  if (options.fast && follows) throw badInput("solving near the hand needs a clock: omit --fast");
  if (options.headless && options.device == "mouse")
    throw badInput("--device mouse needs the picture: omit --headless");
  if (options.headless && !(options.screenshot.empty() && options.video.empty()))
    throw badInput("--headless draws no picture: omit it for --screenshot and --record-video");
}

CLI::IsMember oneOf(std::span<const std::string_view> words) {
  return CLI::IsMember(std::vector<std::string>(words.begin(), words.end()));
}

/// Adds the options that change what the hand feels, and how a virtual hand moves.
std::function<ExitCode()> prepareView(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  addRequired(
      app, "DATASET", options->datasets,
      "Sealed datasets, OUT.h5; the picture can switch between them. Or a scene, SCENE.toml, "
      "which is solved near the hand",
      "FILE");
  app.add_option("--live", options->live,
                 "Scene of the first dataset: solve it near the hand, and correct the forces")
      ->type_name("SCENE");
  const std::function<void()> complete = addViewOptions(app, options);
  app.footer(
      "Ends when the window is closed, after --duration, at the end of a replay, or on Ctrl-C;\n"
      "then prints the statistics of the loop. The force never exceeds the limit of the device\n"
      "(docs/client.md).\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.");
  return [options, complete] {
    complete();
    return view(*options, std::cout);
  };
}

}  // namespace

std::function<void()> addViewOptions(CLI::App& app, const std::shared_ptr<ViewOptions>& options) {
  auto contact = std::make_shared<std::string>();
  app.add_option("--device", options->device, deviceHelp(true))
      ->type_name("WORD")
      ->default_str(fmt::format("{} in a window, else {}", window_device, default_device));
  options->keys.addTo(app, "Use a network device or live solver that requires no key");
  app.add_option("--profile", options->profile,
                 "Use this device's force and stiffness limits [the device's own]")
      ->check(oneOf(device_words));
  app.add_option("--follower", options->follower,
                 "Live solver on another machine (palpate follow) [one is started here]")
      ->type_name("ENDPOINT");
  app.add_option("--method", options->method, "Interpolation method at the start")
      ->check(CLI::IsMember(forceFieldMethods()))
      ->capture_default_str();
  app.add_option("--build", options->build,
                 "Also build this dataset of the scene, and use its finished sites")
      ->type_name("OUT.h5");
  app.add_option("--hold", options->hold,
                 "Recording whose tool moves a second finger that holds the body")
      ->type_name("RUN.h5");
  app.add_option("--contact", *contact, "Contact mode [the scene's]")
      ->check(oneOf(words_of<ContactMode>));
  app.add_option("--friction", options->friction, "Friction coefficient of unilateral contact")
      ->capture_default_str();
  app.add_option("--reach", options->reach,
                 "Touchable distance from an active node, m (0: to the neighbouring nodes)")
      ->capture_default_str();
  app.add_option("--rate", options->rate, "Ticks per second")->capture_default_str();
  app.add_option("--hand-speed", options->hand_speed,
                 "Speed at which the virtual hand slides over the area of a finger, m/s")
      ->capture_default_str();
  app.add_option("--duration", options->duration, "Length of the run, s (0: no limit)")
      ->capture_default_str();
  app.add_flag("--headless", options->headless, "No picture; needs no display");
  app.add_flag("--fast", options->fast,
               "Run ticks without waiting for the clock (virtual hand, replay)");
  app.add_flag("--real-time", options->real_time, "Request SCHED_FIFO and locked memory");
  app.add_option("--record", options->record, "Write every tick to FILE")->type_name("FILE");
  app.add_option("--screenshot", options->screenshot, "Write the last picture to FILE as PNG")
      ->type_name("FILE");
  app.add_option("--record-video", options->video, "Write every frame to DIR as numbered PNG")
      ->type_name("DIR");
  app.add_flag("--json", options->json, "Print the statistics of the loop as one JSON object");
  return [options, contact] {
    if (!contact->empty())
      options->contact =
          *contact == word(ContactMode::glued) ? ContactMode::glued : ContactMode::unilateral;
    if (options->device.empty())
      options->device = options->headless || options->fast ? default_device : window_device;
    check(*options);
  };
}

const Verb view_verb = {"view", "Feel and see a dataset: the haptic client", prepareView};

}  // namespace palpate
