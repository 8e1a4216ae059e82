#include "viewer/picture/picture.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/haptics/same_touch.hpp"
#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/held_tool.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/picture/stage.hpp"
#include "viewer/picture/touch_words.hpp"
#include "viewer/picture/view_keys.hpp"
#include "viewer/picture/window.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

constexpr double longest_arrow = 0.9;  ///< length of the arrow of full_force, in radii of the scene

}  // namespace

struct Picture::Impl {
  Impl(const std::vector<const HapticModel*>& models, const PictureOptions& options)
      : window("Palpate", options.width, options.height, options.visible, options.vsync),
        panels(window.handle()) {
    show(models);
    shot.lattice = &lattice;
    shot.tool.extent = shown.front()->sphere().radius;
    view.ghost = options.ghost;
    view.lattice = options.lattice;
  }

  void show(const std::vector<const HapticModel*>& models) {
    shown.clear();
    for (const HapticModel* each : models) shown.push_back(std::make_unique<BodyView>(*each));
  }

  /// Keeps the view, and forgets everything that refers to the old models.
  void replace(const std::vector<const HapticModel*>& models) {
    PALPATE_ASSERT(models.size() == shown.size(), "each model must have its replacement");
    const std::vector<std::unique_ptr<BodyView>> old = std::move(shown);
    show(models);
    for (std::size_t n = 0; n < shown.size(); ++n) shown[n]->useScaleOf(*old[n]);
    beside.reset();
    lattice = {};
    if (model >= 0) shot.body = &inUse();
  }

  BodyView& inUse() const { return *shown[at(model)]; }

  void use(std::int32_t number) {
    if (number == model) return;
    PALPATE_ASSERT(at(number) < shown.size(), "a state must refer to a loaded dataset");
    const std::optional<FramedSphere> before =
        model < 0 ? std::nullopt : std::optional(inUse().sphere());
    model = number;
    BodyView& now = inUse();
    shot.body = &now;
    // If the bodies have the same place and size, keep the user's view: probably only their
    // materials differ.
    if (before && isFramedWith(*before, now.sphere())) return;
    if (before) return frameAll();
    const Viewport all = panels.view();
    shot.camera.frame(now.sphere().centre, now.sphere().radius, now.bestView(),
                      Eigen::Vector3d::UnitY(), static_cast<double>(all.width) / all.height);
  }

  void frameAll() { frame(shot.camera, inUse(), touchedPart()); }

  /// Frames the body from the direction in which the camera is now.
  static void frame(OrbitCamera& camera, const BodyView& body, const Viewport& part) {
    const FramedSphere& sphere = body.sphere();
    camera.frame(sphere.centre, sphere.radius, static_cast<double>(part.width) / part.height);
  }

  /// Returns the input by mouse. part: the part of the view that shows the touched body. If a
  /// second body is drawn to the right of it, a position there is moved to the same place in
  /// `part`.
  MouseMotion mouse(const Viewport& part) const {
    const ImGuiIO& io = ImGui::GetIO();
    const double height = part.height / static_cast<double>(io.DisplayFramebufferScale.y),
                 width = part.width / static_cast<double>(io.DisplayFramebufferScale.x);
    MouseMotion motion;
    if (ImGui::IsMousePosValid()) {
      motion.right = io.MouseDelta.x / height;
      motion.upward = -io.MouseDelta.y / height;
      const double x = beside && io.MousePos.x >= width ? io.MousePos.x - width : io.MousePos.x;
      motion.at = {(x - width / 2) / height, 0.5 - io.MousePos.y / height};
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
    PersonsInput input{.motion = mouse(touchedPart())};
    input.hand.seconds = now - std::exchange(listened, now);
    obeyHandKeys(window.keys(), window.strokes(), input);
    return input;
  }

  void showBody(BodyView& body, const Touch& touch, std::int32_t method,
                const std::optional<Touch>& second = {}) {
    body.deform(touch, second);
    // The errors of a method are unknown until the method is prepared.
    const bool known = body.model().isPrepared(at(method));
    body.shade(known ? view.colour : SurfaceColour::tissue, method);
    body.showGhost(view.ghost);
    body.setShadow(held.shadow(shot.tool.radius()));
  }

  /// Shows the next dataset in the same touch, if the user chose to see it.
  void compare(const HapticState& state) {
    const bool before = std::exchange(beside, std::nullopt).has_value();
    if (view.beside && shown.size() > 1) {
      BodyView& other = *shown[(at(model) + 1) % shown.size()];
      const std::size_t method = at(state.method);
      beside = {&other, sameTouch(inUse().model(), state.touch, other.model(), method)};
      // If the other dataset cannot repeat this touch, the two are not compared and each has its
      // own scale. The larger of two scales would make the colours of the other body pale.
      const bool compared = beside->touch.has_value();
      if (compared) other.useScaleOf(inUse());
      showBody(other, beside->touch.value_or(Touch()), state.method);
      if (compared) inUse().useScaleOf(other);
    }
    if (before != beside.has_value()) frameAll();
  }

  void showTool(const HapticState& state, const PictureStatus& status) {
    show(state, control.toolIsThere(state, status), status, held, shot.tool);
    shot.held.reset();
    second.reset();
    if (!state.hold) return;
    second = heldTouch(inUse().model(), *state.hold, state.hold_force);
    HapticState other;
    other.touch = *second;
    other.tool = second->anchor_position + second->displacement;
    other.force = second->force;
    shot.held = shot.tool;
    shot.held->holds = true;
    show(other, true, status, second_held, *shot.held);
  }

  void show(const HapticState& state, bool there, const PictureStatus& status, HeldTool& hand,
            ShownTool& tool) {
    hand.update(inUse().model(), state, there, shot.camera, inUse().sphere().radius);
    // The rounded end of the scale is at most the device's largest force, so that the arrow of this
    // force has its full length.
    const double force = state.force.norm();
    if (force > full_force)
      full_force = std::max(force, std::min(roundUp(force), status.max_force));
    tool.shape = toolOf(inUse().model(), at(lattice.space()));
    tool.pose = hand.pose();
    tool.see_through = view.lattice;
    showForce(tool, state.force, isUncertain(state.touch));
    tool.skin.reset();
    tool.anchor.reset();
    if (state.touch.touching)
      tool.anchor = state.touch.anchor_position;
    else
      tool.skin = held.skin().place;
  }

  void showForce(ShownTool& tool, const Eigen::Vector3d& force, bool uncertain) const {
    // draw no arrow for NaN
    tool.arrow = force.allFinite() ? arrowOf(force) : Eigen::Vector3d::Zero();
    tool.uncertain = uncertain;
  }

  Eigen::Vector3d arrowOf(const Eigen::Vector3d& force) const {
    return longest_arrow * inUse().sphere().radius / full_force * force;
  }

  ViewLabel labelOf(const Eigen::Vector3d& tool, const Eigen::Vector3d& force,
                    const Touch& touch) const {
    return {.from = tool,
            .at = tool + arrowOf(force),
            .text = forceText(force, touch),
            .uncertain = isUncertain(touch)};
  }

  BesideContents besideContents(const HapticState& state) const {
    const BodyView& body = *beside->body;
    const std::optional<Touch>& touch = beside->touch;
    if (!touch)
      return {
          .body = body,
          .sentence = untouchedText(sameSurface(inUse().model().surface(), body.model().surface()),
                                    isFramedWith(inUse().sphere(), body.sphere()))};
    const bool pressures = view.colour == SurfaceColour::pressure;
    return {.body = body,
            .label = labelOf(state.shownTool(), touch->force, *touch),
            .force = touch->force.norm(),
            .sentence = pressures ? whyNoPressures(body.model().pressures()) : ""};
  }

  PanelContents contents(const HapticState& state, const PictureStatus& status) const {
    const HapticModel& now = inUse().model();
    PALPATE_ASSERT(at(lattice.space()) < now.spaces().size(), "the lattice must be of this model");
    const auto method = static_cast<std::size_t>(state.method);
    PanelContents all{.state = state,
                      .status = status,
                      .history = history,
                      .lamps = lamps,
                      .camera = shot.camera,
                      .keys = window.keys(),
                      .body = inUse(),
                      .space = now.spaces()[at(lattice.space())],
                      .tool = shot.tool,
                      .label = labelOf(state.shownTool(), state.force, state.touch),
                      .hand = control.marks()};
    for (const auto& each : shown)
      all.models.push_back({each->model().name(), each->model().preparedShare(method)});
    for (std::size_t m = 0; m < now.methods().size(); ++m)
      all.methods.push_back({now.methods()[m], now.preparedShare(m)});
    if (beside) all.beside.emplace(besideContents(state));
    if (second)
      all.held.emplace(
          HeldContents{*second, labelOf(shot.held->pose.tip, second->force, *second), *shot.held});
    return all;
  }

  void render() {
    stage.render(shot, touchedPart());
    if (beside) stage.render(besideShot(), viewport.rightHalf(), false);
    panels.render();
  }

  /// Returns the shot of the other dataset, with the same tool and seen from the same direction.
  Shot besideShot() const {
    Shot other = shot;
    other.body = beside->body;
    other.held.reset();
    if (!isFramedWith(inUse().sphere(), beside->body->sphere()))
      frame(other.camera, *beside->body, viewport.rightHalf());
    if (beside->touch)
      showForce(other.tool, beside->touch->force, isUncertain(*beside->touch));
    else
      other.tool.pose.tip = nowhere();
    return other;
  }

  Viewport touchedPart() const { return beside ? viewport.leftHalf() : viewport; }

  PictureRequests draw(const HapticState& state, const PictureStatus& status) {
    PictureRequests requests;
    window.poll();
    // The input up to this point takes effect in this frame.
    panels.begin();
    viewport = panels.view();
    const auto last = static_cast<std::int32_t>(shown.size()) - 1;
    use(std::clamp(state.model, 0, last));
    history.add(state.time, state.force, state.touch.error_bound);
    lamps.update(glfwGetTime(), state.guards, status.loop.guards);
    // Do this before the input by mouse, which then moves the framed view.
    if (!ImGui::GetIO().WantTextInput && std::ranges::count(window.keys(), GLFW_KEY_F) > 0) {
      frameAll();
      // A body may have taken over the scale of the body beside it, so all of them are reset.
      for (const auto& each : shown) each->forgetScale();
    }
    requests.tool = control.apply(persons(), inUse().model(), state, status, shot.camera);
    lattice.show(inUse(), state, view);
    showTool(state, status);
    showBody(inUse(), state.touch, state.method, second);
    compare(state);
    panels.build(contents(state, status), view, requests);
    render();
    window.swap();
    return requests;
  }

  Window window;
  Panels panels;
  std::vector<std::unique_ptr<BodyView>> shown;  ///< in the order of HapticState::model
  Stage stage;
  LatticeView lattice;
  Shot shot;  ///< of the last frame
  HeldTool held, second_held;
  std::optional<Touch> second;  ///< of the second finger, if it holds the body
  HandControl control;
  double listened = 0;  ///< s, glfwGetTime() of the last frame
  ViewChoices view;
  ForceHistory history;
  GuardLamps lamps;
  std::int32_t model = -1;  ///< of the last frame
  Viewport viewport;        ///< of the last frame
  double full_force = 0.5;  ///< force of the longest arrow, N: a round number that grows with the
                            ///< largest force seen
  /// The other dataset, if it is shown. Without a touch its body is at rest.
  struct Beside {
    BodyView* body;
    std::optional<Touch> touch;
  };
  std::optional<Beside> beside;
};

Picture::Picture(const std::vector<const HapticModel*>& models, const PictureOptions& options) {
  PALPATE_ASSERT(!models.empty(), "at least one dataset must be given");
  impl_ = std::make_unique<Impl>(models, options);
}

Picture::~Picture() = default;

void Picture::replace(const std::vector<const HapticModel*>& models) { impl_->replace(models); }

bool Picture::wantsClose() const { return impl_->window.wantsClose(); }

PictureRequests Picture::draw(const HapticState& state, const PictureStatus& status) {
  return impl_->draw(state, status);
}

Image Picture::grab() {
  PALPATE_ASSERT(impl_->shot.body != nullptr, "a picture must have been drawn");
  impl_->render();
  return readPixels(impl_->viewport.window_width, impl_->viewport.window_height);
}

}  // namespace palpate
