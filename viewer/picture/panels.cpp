#include "viewer/picture/panels.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl2.h>

#include <algorithm>
#include <cmath>

#include "viewer/picture/panel_style.hpp"

namespace palpate {
namespace {

constexpr int side_width = 300, plot_height = 178;  // px

/// Colours, paddings and spacings of all panels of the current ImGui context.
void setPanelStyle() {
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = style.WindowBorderSize = 0;
  style.FrameRounding = 3;
  style.WindowPadding = {14, 12};
  style.ItemSpacing = {8, 5};
  style.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(ink);
  style.Colors[ImGuiCol_TextDisabled] = {0.42F, 0.45F, 0.51F, 1};
  style.Colors[ImGuiCol_FrameBg] = {0.90F, 0.915F, 0.935F, 1};
  style.Colors[ImGuiCol_Button] = {0.83F, 0.87F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonHovered] = {0.70F, 0.80F, 0.92F, 1};
  style.Colors[ImGuiCol_ButtonActive] = {0.55F, 0.71F, 0.90F, 1};
  style.Colors[ImGuiCol_CheckMark] = {0.09F, 0.33F, 0.66F, 1};
}

/// The part of the window that panels leave free, in ImGui's units.
Viewport layout() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  Viewport view;
  view.window_width = std::max(static_cast<int>(size.x), 1);
  view.window_height = std::max(static_cast<int>(size.y), 1);
  view.width = std::max(view.window_width - side_width, 1);
  view.height = std::max(view.window_height - plot_height, 1);
  return view;
}

}  // namespace

Panels::Panels(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  // Panels lie where layout() puts them: nothing is worth a file in the folder of the person.
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
  setPanelStyle();
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL2_Init();
}

Panels::~Panels() {
  ImGui_ImplOpenGL2_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Panels::begin() {
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
  drawHandMarks(contents.hand, contents.camera, viewport);
  ImGui::Render();
}

void Panels::render() { ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData()); }

}  // namespace palpate
