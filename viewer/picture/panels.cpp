#include "viewer/picture/panels.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl2.h>

#include <algorithm>
#include <cmath>

#include "viewer/picture/force_plot.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/side_panel.hpp"
#include "viewer/picture/view_keys.hpp"
#include "viewer/picture/view_overlay.hpp"
#include "viewer/picture/window.hpp"

namespace palpate {
namespace {

// Shares are fractions of the window; the other numbers are px.
constexpr float side_share = 0.30F, narrowest_side = 216, widest_side = 292;
constexpr float plot_share = 0.24F, lowest_plot = 84, highest_plot = 178;

/// Returns the part of the window that no panel covers, in ImGui's units.
Viewport layout() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  Viewport view;
  view.window_width = std::max(static_cast<int>(size.x), 1);
  view.window_height = std::max(static_cast<int>(size.y), 1);
  const float side = std::clamp(side_share * size.x, px(narrowest_side), px(widest_side)),
              plot = std::clamp(plot_share * size.y, px(lowest_plot), px(highest_plot));
  view.width = std::max(static_cast<int>(size.x - side), 1);
  view.height = std::max(static_cast<int>(size.y - plot), 1);
  return view;
}

}  // namespace

Panels::Panels(GLFWwindow* window) : window_(window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  // layout() places the panels, so ImGui need not write a file of their positions to the user's
  // folder.
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL2_Init();
}

Panels::~Panels() {
  ImGui_ImplOpenGL2_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Panels::fitScreen() {
  const double scale = screenScale(window_), units = pixelsPerUnit(window_);
  if (scale == scale_ && units == units_) return;
  if (scale_ > 0) ImGui_ImplOpenGL2_DestroyFontsTexture();
  setPanelStyle(scale, units);
  ImGui_ImplOpenGL2_CreateFontsTexture();
  scale_ = scale;
  units_ = units;
}

void Panels::begin() {
  fitScreen();
  ImGui_ImplOpenGL2_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

Viewport Panels::view() const {
  Viewport view = layout();
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  const auto scaled = [](int length, float factor) {
    return std::max(static_cast<int>(std::lround(static_cast<float>(length) * factor)), 1);
  };
  view.window_width = scaled(view.window_width, scale.x);
  view.window_height = scaled(view.window_height, scale.y);
  view.width = scaled(view.width, scale.x);
  view.height = scaled(view.height, scale.y);
  view.y = view.window_height - view.height;
  return view;
}

void Panels::build(const PanelContents& contents, ViewChoices& view, PictureRequests& requests) {
  const Viewport viewport = layout();
  obeyKeys(contents, view, requests);
  buildSidePanel(contents, viewport, view, requests);
  buildForcePlot(contents.history, viewport);
  drawViewOverlay(contents, view, viewport);
  ImGui::Render();
}

void Panels::render() { ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData()); }

}  // namespace palpate
