#include "viewer/picture/picture.hpp"

#include <GL/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/error.hpp"
#include "viewer/haptics/deformed_shape.hpp"
#include "viewer/picture/panels.hpp"
#include "viewer/picture/view_control.hpp"
#include "viewer/picture/window.hpp"

namespace palpate {
namespace {

constexpr double longest_arrow = 0.9;  ///< of the scene's radius, at the device's largest force

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The ball around all vertices, nearly the smallest.
FramedSphere sphereAround(const std::vector<Eigen::Vector3d>& vertices) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : vertices) box.extend(vertex);
  FramedSphere sphere{box.center(), 0};
  for (const Eigen::Vector3d& vertex : vertices)
    sphere.radius = std::max(sphere.radius, (vertex - sphere.centre).norm());
  return sphere;
}

std::vector<bool> touchableTriangles(const TouchSurface& surface) {
  std::vector<bool> touchable(surface.triangles().size());
  for (std::size_t t = 0; t < touchable.size(); ++t)
    touchable[t] = surface.touchable(static_cast<std::int32_t>(t));
  return touchable;
}

/// From where the touchable surface is seen best: along its mean normal, else as a device stands (z
/// toward the person, y up), and a little from above.
Eigen::Vector3d bestView(const TouchSurface& surface) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    if (!surface.touchable(static_cast<std::int32_t>(t))) continue;
    const Triangle& corners = surface.triangles()[t];
    const auto vertex = [&](std::size_t n) -> const Eigen::Vector3d& {
      return surface.vertices()[static_cast<std::size_t>(corners[n])];
    };
    normal += (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
  }
  if (normal.norm() > 0) normal.normalize();
  // From the side of the normal: an arrow toward the eye would be a dot.
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(normal);
  return 0.8 * normal + 0.75 * right + 0.35 * Eigen::Vector3d::UnitY() +
         0.25 * Eigen::Vector3d::UnitZ();
}

/// Where the active node of a space is at rest.
Eigen::Vector3d originOf(const HapticModel& model, std::size_t space) {
  const TouchSurface& surface = model.surface();
  const std::int32_t vertex = surface.activeVertex(space);
  return vertex >= 0 ? surface.vertices()[static_cast<std::size_t>(vertex)]
                     : sphereAround(surface.vertices()).centre;
}

/// The smallest of 1, 2 and 5 times a power of ten that holds `length`.
double roundUp(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (length <= factor * power * (1 + 1e-9)) return factor * power;
  return 10 * power;
}

/// All that is drawn of one model.
struct ShownModel {
  explicit ShownModel(const HapticModel& of)
      : model(of),
        sphere(sphereAround(of.surface().vertices())),
        body(SurfaceShape(of.surface().vertices(), of.surface().triangles(),
                          touchableTriangles(of.surface()))),
        deformed(of.surface().vertices().size()),
        displacements(3 * of.surface().vertices().size()) {
    body.setGhostFrom(0.01 * sphere.radius);
  }
  const HapticModel& model;
  FramedSphere sphere;
  BodyView body;
  DeformedShape deformed;
  std::vector<float> displacements;  ///< [vertex][axis], m
  double full_colour = 0.005;        ///< m, grows with what was seen
};

/// What decides which dots the lattice shows.
struct LatticeKey {
  std::int32_t model = -1, method = -1;
  std::size_t space = 0;
  bool errors = false, cut = false;
  int axis = 0;
  double offset = 0;
  bool operator==(const LatticeKey&) const = default;
};

}  // namespace

struct Picture::Impl {
  Impl(std::vector<const HapticModel*> all, const PictureOptions& chosen)
      : options(chosen),
        models(std::move(all)),
        window("Palpate", chosen.width, chosen.height, chosen.visible, chosen.vsync),
        panels(window.handle()) {
    for (const HapticModel* each : models) shown.push_back(std::make_unique<ShownModel>(*each));
    stage = std::make_unique<Stage>(shown.front()->sphere.radius);
    view.ghost = options.ghost;
    view.lattice = options.lattice;
  }

  PictureRequests draw(const HapticState& state, const PictureStatus& status);
  void use(std::int32_t model);
  void frameAll();
  MouseMotion mouse(const Viewport& viewport) const;
  void showBody(const Touch& touch);
  void showTool(const HapticState& state, const PictureStatus& status);
  void showLattice(const HapticState& state);
  const std::vector<CellError>& errorsOf(const HapticState& state);
  PanelContents contents(const HapticState& state, const PictureStatus& status) const;
  std::vector<ViewLabel> labels(const HapticState& state) const;
  void render();
  void measured(double& cost);

  PictureOptions options;
  std::vector<const HapticModel*> models;
  Window window;
  Panels panels;
  std::vector<std::unique_ptr<ShownModel>> shown;
  std::unique_ptr<Stage> stage;
  ViewControl control;
  ViewChoices view;
  ForceHistory history;
  GuardLamps lamps;
  PictureCosts costs;
  double measured_until = 0;
  std::int32_t model = -1;  ///< that is on the stage
  Viewport viewport;        ///< of the last picture
  bool drawn = false;
  Eigen::Vector3d arrow_tip = Eigen::Vector3d::Zero();
  std::size_t space = 0;  ///< that the lattice shows
  LatticeKey lattice;
  std::map<std::array<std::size_t, 3>, std::vector<CellError>> errors;  ///< by model, method, space
};

void Picture::Impl::use(std::int32_t number) {
  if (number == model) return;
  const bool first = model < 0;
  model = number;
  space = 0;
  ShownModel& now = *shown[static_cast<std::size_t>(model)];
  stage->setBody(&now.body);
  if (!first) return;  // the person keeps the view while materials change
  const Viewport all = panels.view();
  stage->camera().frame(now.sphere.centre, now.sphere.radius, bestView(now.model.surface()),
                        Eigen::Vector3d::UnitY(), static_cast<double>(all.width) / all.height);
}

void Picture::Impl::frameAll() {
  const FramedSphere& sphere = shown[static_cast<std::size_t>(model)]->sphere;
  stage->camera().frame(sphere.centre, sphere.radius,
                        static_cast<double>(viewport.width) / viewport.height);
}

MouseMotion Picture::Impl::mouse(const Viewport& part) const {
  const ImGuiIO& io = ImGui::GetIO();
  const double height = part.height / static_cast<double>(io.DisplayFramebufferScale.y);
  MouseMotion motion;
  if (ImGui::IsMousePosValid()) {
    motion.right = io.MouseDelta.x / height;
    motion.upward = -io.MouseDelta.y / height;
  }
  motion.over_view = !io.WantCaptureMouse;
  motion.wheel = io.MouseWheel;
  motion.left = io.MouseDown[0];
  motion.other = io.MouseDown[1] || io.MouseDown[2];
  motion.shift = io.KeyShift;
  motion.control = io.KeyCtrl;
  return motion;
}

void Picture::Impl::showBody(const Touch& touch) {
  ShownModel& now = *shown[static_cast<std::size_t>(model)];
  now.deformed.evaluate(now.model, touch, now.displacements);
  measured(costs.shape);
  SurfaceShape& shape = now.body.shape();
  shape.setDisplacements(now.displacements);
  if (shape.largest() > now.full_colour) now.full_colour = roundUp(shape.largest());
  shape.setColours(now.full_colour);
  now.body.showGhost(view.ghost);
  measured(costs.arrays);
}

void Picture::Impl::showTool(const HapticState& state, const PictureStatus& status) {
  ToolView& tool = stage->tool();
  tool.setTool(state.tool);
  const double radius = shown[static_cast<std::size_t>(model)]->sphere.radius;
  const double metres = longest_arrow * radius / std::max(status.max_force, 1e-3);  // per newton
  const Eigen::Vector3d arrow = metres * state.force;
  tool.setArrow(arrow);
  arrow_tip = state.tool + arrow;
  if (state.touch.touching)
    tool.showAnchor(state.touch.anchor_position);
  else
    tool.hideAnchor();
}

const std::vector<CellError>& Picture::Impl::errorsOf(const HapticState& state) {
  const auto method = static_cast<std::size_t>(state.method);
  auto [found, added] = errors.try_emplace({static_cast<std::size_t>(model), method, space});
  const HapticModel& now = *models[static_cast<std::size_t>(model)];
  if (added) found->second = cellErrors(now.spaces()[space], now.field(method, space));
  return found->second;
}

void Picture::Impl::showLattice(const HapticState& state) {
  double most = 0;
  for (std::int32_t n = 0; state.touch.touching && n < state.touch.blend.size; ++n) {
    const SpaceWeight& share = state.touch.blend.shares[static_cast<std::size_t>(n)];
    if (share.weight > most) space = static_cast<std::size_t>(share.space);
    most = std::max(most, share.weight);
  }
  stage->lattice().show(view.lattice);
  if (!view.lattice) return;
  const LatticeKey wanted{model,
                          view.errors ? state.method : -1,
                          space,
                          view.errors,
                          view.cut,
                          view.plane.axis,
                          view.plane.offset};
  if (wanted == lattice) return;
  lattice = wanted;
  const HapticModel& now = *models[static_cast<std::size_t>(model)];
  const SpaceTable& table = now.spaces()[space];
  const std::optional<LatticeCut> cut = view.cut ? std::optional(view.plane) : std::nullopt;
  const std::vector<LatticeDot> dots =
      view.errors
          ? errorDots(errorsOf(state), ErrorScale(errorsOf(state)), table.lattice.spacing(), cut)
          : tagDots(table, cut);
  stage->lattice().setDots(dots, originOf(now, space), view.cut ? 7 : 4);
}

std::vector<ViewLabel> Picture::Impl::labels(const HapticState& state) const {
  if (!state.touch.touching && state.force.norm() == 0) return {};
  std::string text = fmt::format("{:.2f} N", state.force.norm());
  if (state.touch.touching && std::isfinite(state.touch.error_bound))
    text += fmt::format(" \xC2\xB1 {:.2g} N", state.touch.error_bound);
  return {{arrow_tip, text}};
}

PanelContents Picture::Impl::contents(const HapticState& state, const PictureStatus& status) const {
  const ShownModel& now = *shown[static_cast<std::size_t>(model)];
  PanelContents all{.state = state,
                    .status = status,
                    .history = history,
                    .lamps = lamps,
                    .camera = stage->camera(),
                    .keys = window.keys(),
                    .models = {},
                    .methods = now.model.methods(),
                    .spaces = {},
                    .full_colour = now.full_colour,
                    .lattice_radius = now.model.spaces()[space].lattice.radius(),
                    .errors = {},
                    .lattice_name = now.model.spaces()[space].patch.name,
                    .labels = labels(state)};
  for (const HapticModel* each : models) all.models.push_back(each->name());
  for (const SpaceTable& table : now.model.spaces()) all.spaces.push_back(table.patch.name);
  const auto found =
      errors.find({static_cast<std::size_t>(model), static_cast<std::size_t>(state.method), space});
  if (view.errors && found != errors.end()) all.errors = ErrorScale(found->second);
  return all;
}

void Picture::Impl::measured(double& cost) {
  if (!options.measure) return;
  glFinish();
  const double now = processorSeconds();
  cost = now - measured_until;
  measured_until = now;
}

void Picture::Impl::render() {
  stage->render(viewport);
  panels.render();
}

PictureRequests Picture::Impl::draw(const HapticState& state, const PictureStatus& status) {
  PictureRequests requests;
  window.poll();
  if (options.measure) measured_until = processorSeconds();
  panels.begin();
  viewport = panels.view();
  const auto last = static_cast<std::int32_t>(models.size()) - 1;
  use(std::clamp(state.model, 0, last));
  history.add(state.time, state.force);
  lamps.update(glfwGetTime(), state.guards, status.loop.guards);
  if (!ImGui::GetIO().WantTextInput && std::ranges::count(window.keys(), GLFW_KEY_F) > 0)
    frameAll();
  requests.mouse_target = control.apply(
      mouse(viewport), state.tool, shown[static_cast<std::size_t>(model)]->sphere, stage->camera());
  requests.mouse_holds = requests.mouse_target.has_value();
  showBody(state.touch);
  showTool(state, status);
  showLattice(state);
  panels.build(contents(state, status), view, requests);
  double layout = 0;
  measured(layout);
  stage->render(viewport);
  measured(costs.scene);
  panels.render();
  measured(costs.panels);
  costs.panels += layout;
  window.swap();
  measured(costs.swap);
  drawn = true;
  return requests;
}

Picture::Picture(std::vector<const HapticModel*> models, const PictureOptions& options) {
  if (models.empty()) throw failure("a picture needs a dataset to show");
  impl_ = std::make_unique<Impl>(std::move(models), options);
}

Picture::~Picture() = default;

bool Picture::wantsClose() const { return impl_->window.wantsClose(); }

PictureRequests Picture::draw(const HapticState& state, const PictureStatus& status) {
  return impl_->draw(state, status);
}

Image Picture::grab() {
  if (!impl_->drawn) throw failure("no picture was drawn yet that could be kept");
  impl_->render();
  return readPixels(impl_->viewport.window_width, impl_->viewport.window_height);
}

PictureCosts Picture::costs() const { return impl_->costs; }

}  // namespace palpate
