#include "viewer/picture/picture.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/held_tool.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/picture/stage.hpp"
#include "viewer/picture/touch_words.hpp"
#include "viewer/picture/window.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

constexpr double longest_arrow = 0.9;  ///< of the scene's radius, at full_force

}  // namespace

struct Picture::Impl {
  Impl(const std::vector<const HapticModel*>& models, const PictureOptions& options)
      : window("Palpate", options.width, options.height, options.visible, options.vsync),
        panels(window.handle()),
        control(options.tutorial) {
    for (const HapticModel* each : models) shown.push_back(std::make_unique<BodyView>(*each));
    stage = std::make_unique<Stage>(shown.front()->sphere().radius);
    view.ghost = options.ghost;
    view.lattice = options.lattice;
  }

  BodyView& inUse() const { return *shown[at(model)]; }

  void use(std::int32_t number) {
    if (number == model) return;
    const bool first = model < 0;
    model = number;
    BodyView& now = inUse();
    stage->setBody(now);
    if (!first) return;  // the person keeps the view while materials change
    const Viewport all = panels.view();
    stage->camera().frame(now.sphere().centre, now.sphere().radius, now.bestView(),
                          Eigen::Vector3d::UnitY(), static_cast<double>(all.width) / all.height);
  }

  void frameAll() {
    const FramedSphere& sphere = inUse().sphere();
    stage->camera().frame(sphere.centre, sphere.radius,
                          static_cast<double>(viewport.width) / viewport.height);
  }

  MouseMotion mouse(const Viewport& part) const {
    const ImGuiIO& io = ImGui::GetIO();
    const double height = part.height / static_cast<double>(io.DisplayFramebufferScale.y),
                 width = part.width / static_cast<double>(io.DisplayFramebufferScale.x);
    MouseMotion motion;
    if (ImGui::IsMousePosValid()) {
      motion.right = io.MouseDelta.x / height;
      motion.upward = -io.MouseDelta.y / height;
      motion.at = {(io.MousePos.x - width / 2) / height, 0.5 - io.MousePos.y / height};
    }
    motion.over_view = !io.WantCaptureMouse;
    motion.wheel = io.MouseWheel;
    motion.left = io.MouseDown[0];
    motion.right_button = io.MouseDown[1];
    motion.middle = io.MouseDown[2];
    motion.shift = io.KeyShift;
    return motion;
  }

  PersonsInput persons() {
    const double now = glfwGetTime();
    PersonsInput input{.motion = mouse(viewport), .pressed_a_key = !window.keys().empty()};
    input.hand.seconds = now - std::exchange(listened, now);
    obeyHandKeys(window.keys(), window.strokes(), input);
    return input;
  }

  void showBody(const HapticState& state) {
    inUse().deform(state.touch);
    inUse().shade(view.colour, state.method);
    inUse().showGhost(view.ghost);
    inUse().setShadow(held.shadow(stage->tool().radius()));
  }

  void showTool(const HapticState& state, const PictureStatus& status) {
    ToolView& tool = stage->tool();
    const double radius = inUse().sphere().radius;
    held.update(inUse().model(), state, control.toolIsThere(state, status), stage->camera(),
                radius);
    tool.setShape(toolOf(inUse().model(), at(stage->lattice().space())));
    tool.setTool(held.pose());
    tool.setSeeThrough(view.lattice);
    tool.setSkin(held.skin(), !state.touch.touching);
    // No arrow is longer than that of the device's largest force, so the scale grows no further.
    const double force = state.force.norm();
    if (force > full_force)
      full_force = std::max(force, std::min(roundUp(force), status.max_force));
    const Eigen::Vector3d arrow = longest_arrow * radius / full_force * state.force;
    tool.setArrow(arrow, isUncertain(state.touch));
    arrow_tip = state.tool + arrow;
    tool.setAnchor(state.touch.anchor_position, state.touch.touching);
  }

  ViewLabel labelOf(const HapticState& state) const {
    const ToolView& tool = stage->tool();
    return {state.tool,    arrow_tip,        tool.axis(),
            tool.radius(), forceText(state), isUncertain(state.touch)};
  }

  PanelContents contents(const HapticState& state, const PictureStatus& status) const {
    const HapticModel& now = inUse().model();
    const SpaceTable& table = now.spaces()[at(stage->lattice().space())];
    PanelContents all{.state = state,
                      .status = status,
                      .history = history,
                      .lamps = lamps,
                      .camera = stage->camera(),
                      .keys = window.keys(),
                      .dataset = now.name(),
                      .tissue = tissueText(now.regions()),
                      .middle = inUse().sphere().centre,
                      .full_colour = inUse().fullColour(),
                      .untouchable = inUse().hasUntouchable(),
                      .lattice_radius = table.lattice.radius(),
                      .lattice_name = table.patch.name,
                      .label = labelOf(state),
                      .hand = control.marks()};
    const auto method = static_cast<std::size_t>(state.method);
    for (const auto& each : shown)
      all.models.push_back({each->model().name(), each->model().preparedShare(method)});
    for (std::size_t m = 0; m < now.methods().size(); ++m)
      all.methods.push_back({now.methods()[m], now.preparedShare(m)});
    for (const SpaceTable& space : now.spaces()) all.spaces.push_back(space.patch.name);
    return all;
  }

  void render() {
    stage->render(viewport);
    panels.render();
  }

  PictureRequests draw(const HapticState& state, const PictureStatus& status) {
    PictureRequests requests;
    window.poll();
    // Input is known from here on; what it asks for is drawn in this very picture.
    panels.begin();
    viewport = panels.view();
    const auto last = static_cast<std::int32_t>(shown.size()) - 1;
    use(std::clamp(state.model, 0, last));
    history.add(state.time, state.force, state.touch.error_bound);
    lamps.update(glfwGetTime(), state.guards, status.loop.guards);
    // Before the mouse, which then moves what is framed.
    if (!ImGui::GetIO().WantTextInput && std::ranges::count(window.keys(), GLFW_KEY_F) > 0)
      frameAll();
    requests.tool = control.apply(persons(), inUse().model(), state, status, stage->camera());
    stage->lattice().show(inUse(), state, view);
    showTool(state, status);
    showBody(state);
    panels.build(contents(state, status), view, requests);
    render();
    window.swap();
    drawn = true;
    return requests;
  }

  Window window;
  Panels panels;
  std::vector<std::unique_ptr<BodyView>> shown;  ///< as HapticState::model counts
  std::unique_ptr<Stage> stage;
  HeldTool held;
  HandControl control;
  double listened = 0;  ///< s, glfwGetTime() of the last picture
  ViewChoices view;
  ForceHistory history;
  GuardLamps lamps;
  std::int32_t model = -1;  ///< that is on the stage
  Viewport viewport;        ///< of the last picture
  bool drawn = false;
  double full_force =
      0.5;  ///< N, of the longest arrow: a round number that grows with what was seen
  Eigen::Vector3d arrow_tip = Eigen::Vector3d::Zero();
};

Picture::Picture(const std::vector<const HapticModel*>& models, const PictureOptions& options) {
  PALPATE_ASSERT(!models.empty(), "a picture shows something");
  impl_ = std::make_unique<Impl>(models, options);
}

Picture::~Picture() = default;

bool Picture::wantsClose() const { return impl_->window.wantsClose(); }

PictureRequests Picture::draw(const HapticState& state, const PictureStatus& status) {
  return impl_->draw(state, status);
}

Image Picture::grab() {
  PALPATE_ASSERT(impl_->drawn, "what is kept is the picture that was drawn last");
  impl_->render();
  return readPixels(impl_->viewport.window_width, impl_->viewport.window_height);
}

}  // namespace palpate
