#include "viewer/view_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "viewer/devices/device_choice.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

constexpr double most_ticks_per_second = 10000;

/// Checks the options before anything is opened. Otherwise another problem could hide a wrong
/// option.
void check(const ViewOptions& options) {
  checkDeviceWord(options.device);
  if (!(options.rate >= 100 && options.rate <= most_ticks_per_second))
    throw badInput("--rate {}: between 100 and {} ticks per second", options.rate,
                   most_ticks_per_second);
  if (!(options.friction >= 0 && options.friction <= 10))
    throw badInput("--friction {}: between 0 and 10", options.friction);
  if (!(options.reach >= 0)) throw badInput("--reach {}: metres, 0 or more", options.reach);
  if (!(options.duration >= 0))
    throw badInput("--duration {}: seconds, 0 or more", options.duration);
  if (options.fast && options.duration <= 0 && !options.device.starts_with("replay"))
    throw badInput("--fast has no clock that could end it: say how long with --duration");
  if (options.fast &&
      !(options.device.starts_with("virtual") || options.device.starts_with("replay")))
    throw badInput("--fast is for the virtual hand and replays: {} has the time of the clock",
                   options.device);
  if (options.headless && options.device == "mouse")
    throw badInput("--device mouse moves the tool in the picture: leave out --headless");
  if (options.headless && !(options.screenshot.empty() && options.video.empty()))
    throw badInput("--headless draws no picture: leave it out for --screenshot and --record-video");
}

CLI::IsMember oneOf(std::span<const std::string_view> words) {
  return CLI::IsMember(std::vector<std::string>(words.begin(), words.end()));
}

std::function<ExitCode()> prepareView(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  auto contact = std::make_shared<std::string>();
  app.add_option("DATASET", options->datasets,
                 "Sealed datasets, OUT.h5; with several the picture switches between them")
      ->required()
      ->type_name("FILE");
  app.add_option("--device", options->device, deviceHelp(true))
      ->type_name("WORD")
      ->default_str(fmt::format("{} in a window, else {}", window_device, default_device));
  options->keys.addTo(app, "Accept a network device that requires no key");
  app.add_option("--profile", options->profile,
                 "Use this device's force and stiffness limits [the device's own]")
      ->check(oneOf(device_words));
  app.add_option("--method", options->method, "Interpolation to begin with")
      ->check(CLI::IsMember(forceFieldMethods()))
      ->capture_default_str();
  app.add_option("--contact", *contact, "Contact mode [the scene's]")
      ->check(oneOf(words_of<ContactMode>));
  app.add_option("--friction", options->friction, "Coulomb's coefficient of unilateral contact")
      ->capture_default_str();
  app.add_option("--reach", options->reach,
                 "How far from an active node you can touch the surface, m [0: to the next nodes]")
      ->capture_default_str();
  app.add_option("--rate", options->rate, "Ticks per second")->capture_default_str();
  app.add_option("--duration", options->duration, "s after which it ends; 0: never")
      ->capture_default_str();
  app.add_flag("--headless", options->headless, "No picture; needs no display");
  app.add_flag("--fast", options->fast, "Tick after tick without a clock (virtual hand, replay)");
  app.add_flag("--real-time", options->real_time, "Ask for SCHED_FIFO and locked memory");
  app.add_option("--record", options->record, "Write every tick to FILE")->type_name("FILE");
  app.add_option("--screenshot", options->screenshot, "Write the last picture to FILE, PNG")
      ->type_name("FILE");
  app.add_option("--record-video", options->video, "Write every picture to DIR, numbered PNG")
      ->type_name("DIR");
  app.add_flag("--json", options->json, "Print the measurements as one JSON object at the end");
  app.footer(
      "Ends with the window, --duration, the end of a replay, or Ctrl-C; "
      "then prints what the loop measured.\n"
      "The force is limited to the device's at all times (docs/client.md). Exit codes: "
      "0 done, 1 failed, 2 wrong usage, 130 interrupted.");
  return [options, contact] {
    if (!contact->empty())
      options->contact =
          *contact == word(ContactMode::glued) ? ContactMode::glued : ContactMode::unilateral;
    if (options->device.empty())
      options->device = options->headless || options->fast ? default_device : window_device;
    check(*options);
    return view(*options, std::cout);
  };
}

}  // namespace

Verb viewVerb() { return {"view", "Feel and see a dataset: the haptic client", prepareView}; }

}  // namespace palpate
