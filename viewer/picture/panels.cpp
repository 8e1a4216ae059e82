#include "viewer/picture/panels.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl2.h>
#include <fmt/format.h>
#include <imgui.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

constexpr int side_width = 300, plot_height = 178;  // px
constexpr ImU32 ink = IM_COL32(38, 42, 52, 255), faint = IM_COL32(38, 42, 52, 110);
constexpr ImU32 red = IM_COL32(196, 30, 30, 255), blue = IM_COL32(24, 84, 170, 255);
constexpr ImU32 paper = IM_COL32(255, 255, 255, 225), line_grey = IM_COL32(214, 219, 227, 255);
constexpr std::array<ImU32, 4> curve_colours = {
    IM_COL32(214, 94, 0, 255), IM_COL32(0, 140, 100, 255), IM_COL32(0, 104, 190, 255),
    IM_COL32(30, 30, 36, 255)};
constexpr std::array<const char*, 4> curve_names = {"x", "y", "z", "|F|"};

void setStyle() {
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

constexpr ImGuiWindowFlags fixed_panel =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground |
    ImGuiWindowFlags_NoBringToFrontOnFocus;

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

void heading(const char* text) {
  ImGui::Dummy({0, 4});
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::TextDisabled("%s", text);
  const float y = at.y + ImGui::GetTextLineHeight() + 2,
              right = at.x + ImGui::GetContentRegionAvail().x;
  ImGui::GetWindowDrawList()->AddLine({at.x, y}, {right, y}, line_grey);
}

/// A name, and a value that begins where all values do.
void row(const char* label, const std::string& value) {
  ImGui::TextUnformatted(label);
  ImGui::SameLine(104);
  ImGui::TextUnformatted(value.c_str());
}

std::string newtons(double force) {
  return std::isfinite(force) ? fmt::format("{:.3f} N", force) : "none";
}

std::string microseconds(double seconds) {
  return seconds < 0.01 ? fmt::format("{:.0f} us", 1e6 * seconds)
                        : fmt::format("{:.1f} ms", 1e3 * seconds);
}

/// A combo over `names`; the number chosen, when another than `current` was.
std::optional<std::int32_t> choose(const char* label, const std::vector<std::string>& names,
                                   std::int32_t current) {
  std::optional<std::int32_t> chosen;
  ImGui::TextUnformatted(label);
  ImGui::SameLine(72);
  ImGui::SetNextItemWidth(-1);
  const auto now = static_cast<std::size_t>(current);
  if (ImGui::BeginCombo(fmt::format("##{}", label).c_str(),
                        now < names.size() ? names[now].c_str() : "")) {
    for (std::size_t n = 0; n < names.size(); ++n)
      if (ImGui::Selectable(fmt::format("{}##{}", names[n], n).c_str(), n == now) && n != now)
        chosen = static_cast<std::int32_t>(n);
    ImGui::EndCombo();
  }
  return chosen;
}

void choices(const PanelContents& contents, ViewChoices& view, PictureRequests& requests) {
  const HapticState& state = contents.state;
  if (const auto model = choose("dataset", contents.models, state.model))
    requests.use = {*model, state.method};
  if (const auto method = choose("method", contents.methods, state.method))
    requests.use = {state.model, *method};
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  if (ImGui::Button("Release", {width, 0})) requests.release = true;
  ImGui::SameLine();
  if (ImGui::Button(contents.status.paused ? "Go on" : "Pause", {width, 0})) requests.pause = true;
  ImGui::SameLine();
  if (ImGui::Button("Reload", {width, 0})) requests.reload = true;
  ImGui::Checkbox("ghost", &view.ghost);
  ImGui::SameLine();
  ImGui::Checkbox("lattice", &view.lattice);
  ImGui::SameLine();
  ImGui::Checkbox("help", &view.help);
}

void latticeChoices(const PanelContents& contents, ViewChoices& view) {
  if (!view.lattice) return;
  heading(fmt::format("Lattice of \"{}\"", contents.lattice_name).c_str());
  if (ImGui::RadioButton("by tag", !view.errors)) view.errors = false;
  ImGui::SameLine();
  if (ImGui::RadioButton("by error", view.errors)) view.errors = true;
  ImGui::Checkbox("cut", &view.cut);
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    ImGui::RadioButton(std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)], &view.plane.axis,
                       axis);
  }
  const auto reach = static_cast<float>(1e3 * contents.lattice_radius);
  auto offset = static_cast<float>(1e3 * view.plane.offset);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##offset", &offset, -reach, reach, "at %.1f mm")) {
    view.plane.offset = 1e-3 * offset;
    view.cut = true;
  }
}

std::string stiffnessText(const Eigen::Matrix3d& stiffness) {
  if (!stiffness.allFinite()) return "none";
  // Of the tissue: minus the derivative of the force on the tool.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(-0.5 * (stiffness + stiffness.transpose()), Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& k = solver.eigenvalues();
  return fmt::format("{:.0f}, {:.0f}, {:.0f} N/m", k[2], k[1], k[0]);
}

void touchNumbers(const Touch& touch) {
  const Eigen::Vector3d u = 1e3 * touch.displacement;
  row("pressed", fmt::format("{:.1f} mm", u.norm()));
  row("", fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", u.x(), u.y(), u.z()));
  row("stiffness", stiffnessText(touch.stiffness));
  row("coverage", fmt::format("{:.0f} %{}", 100 * touch.coverage, touch.inside ? "" : ", outside"));
}

void numbers(const PanelContents& contents) {
  const HapticState& state = contents.state;
  const Touch& touch = state.touch;
  heading("Touch");
  row("force", newtons(state.force.norm()));
  row("of tissue", newtons(touch.force.norm()));
  row("error",
      std::isfinite(touch.error_bound) ? "\xC2\xB1 " + newtons(touch.error_bound) : "unknown");
  if (touch.touching)
    touchNumbers(touch);
  else
    row("gap", fmt::format("{:.1f} mm", 1e3 * touch.gap));
  row("passivity", fmt::format("{:.2f} mJ", 1e3 * state.passivity));
  for (std::int32_t n = 0; touch.touching && n < touch.blend.size; ++n) {
    const SpaceWeight& share = touch.blend.shares[static_cast<std::size_t>(n)];
    const auto space = static_cast<std::size_t>(share.space);
    if (share.weight > 0.005 && space < contents.spaces.size())
      row(n == 0 ? "spaces" : "",
          fmt::format("{:3.0f} % {}", 100 * share.weight, contents.spaces[space]));
  }
}

void lamps(const GuardLamps& lamps) {
  heading("Guards");
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float column = ImGui::GetContentRegionAvail().x / 3, line = ImGui::GetTextLineHeight() + 5;
  for (int bit = 0; bit < guard_count; ++bit) {
    const int row = bit / 3;
    const ImVec2 at = {origin.x + column * static_cast<float>(bit - 3 * row),
                       origin.y + line * static_cast<float>(row)};
    const bool lit = lamps.lit(bit);
    draw.AddCircleFilled({at.x + 6, at.y + 7}, 5,
                         lit ? IM_COL32(240, 130, 0, 255) : IM_COL32(208, 213, 221, 255), 12);
    draw.AddText({at.x + 16, at.y}, lit ? ink : faint, guardWord(bit));
  }
  ImGui::Dummy({0, 3 * line - 4});
}

void loopNumbers(const PictureStatus& status) {
  const LoopFigures& loop = status.loop;
  heading("Loop");
  row("device", status.device.empty() ? "none" : status.device);
  if (loop.rate <= 0) return;
  row("rate", fmt::format("{:.0f} Hz{}", loop.rate, status.recording ? ", recording" : ""));
  ImGui::TextDisabled("%s", "");
  ImGui::SameLine(104);
  ImGui::TextDisabled("p50       p99.9");
  row("period",
      fmt::format("{:<9} {}", microseconds(loop.period_p50), microseconds(loop.period_p999)));
  row("compute",
      fmt::format("{:<9} {}", microseconds(loop.compute_p50), microseconds(loop.compute_p999)));
  row("missed", fmt::format("{} own, {} system", loop.missed_program, loop.missed_system));
  if (loop.halts > 0) row("halts", fmt::format("{}", loop.halts));
}

/// Round steps: 1, 2 or 5 times a power of ten, at most `most` of them up to `highest`.
double roundStep(double highest, int most) {
  const double power = std::pow(10, std::floor(std::log10(highest / most)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power * most >= highest) return factor * power;
  return 10 * power;
}

/// Where the curves of the plot go on the screen.
struct PlotArea {
  ImVec2 from, to;
  double end = 0,
         limit = 1;  ///< s at the right edge; N at the upper one, minus that at the lower one
  ImVec2 at(double time, double force) const {
    const double across = 1 - (end - time) / ForceHistory::span, up = 0.5 * (1 + force / limit);
    return {static_cast<float>(std::lerp(from.x, to.x, across)),
            static_cast<float>(std::lerp(to.y, from.y, up))};
  }
};

void plotGrid(ImDrawList& draw, const PlotArea& area) {
  const double step = roundStep(area.limit, 2);
  for (double force = -std::floor(area.limit / step) * step; force <= area.limit * 1.001;
       force += step) {
    const float y = area.at(area.end, force).y;
    draw.AddLine({area.from.x, y}, {area.to.x, y}, line_grey);
    const std::string text = fmt::format("{:g}", std::abs(force) < 1e-9 ? 0 : force);
    draw.AddText({area.from.x - 8 - ImGui::CalcTextSize(text.c_str()).x, y - 7}, faint,
                 text.c_str());
  }
  for (int second = 0; second <= 5; ++second) {
    const float x = area.at(area.end - second, 0).x;
    draw.AddLine({x, area.from.y}, {x, area.to.y}, line_grey);
    const std::string text = second == 0 ? "now" : fmt::format("-{} s", second);
    draw.AddText({x - ImGui::CalcTextSize(text.c_str()).x / 2, area.to.y + 3}, faint, text.c_str());
  }
}

void plotCurves(ImDrawList& draw, const PlotArea& area, const ForceHistory& history) {
  std::vector<ImVec2> points(history.size());
  for (std::size_t curve = 0; curve < curve_colours.size(); ++curve) {
    for (std::size_t n = 0; n < history.size(); ++n) {
      const ForceHistory::Sample& sample = history.at(n);
      const float force =
          curve < 3 ? sample.force[static_cast<Eigen::Index>(curve)] : sample.force.norm();
      points[n] = area.at(sample.time, force);
    }
    // Whole widths: ImGui draws those with few triangles.
    draw.AddPolyline(points.data(), static_cast<int>(points.size()), curve_colours[curve],
                     ImDrawFlags_None, curve == 3 ? 2.0F : 1.0F);
  }
}

void plotLegend(ImDrawList& draw, ImVec2 at) {
  draw.AddText(at, ink, "force on the tool, N");
  at.x += 168;
  for (std::size_t curve = 0; curve < curve_colours.size(); ++curve) {
    draw.AddLine({at.x, at.y + 7}, {at.x + 16, at.y + 7}, curve_colours[curve], 2);
    draw.AddText({at.x + 21, at.y}, ink, curve_names[curve]);
    at.x += 52;
  }
}

void plot(const PanelContents& contents, const Viewport& view) {
  const auto width = static_cast<float>(view.width);
  ImGui::SetNextWindowPos({0, static_cast<float>(view.height)});
  ImGui::SetNextWindowSize({width, static_cast<float>(view.window_height - view.height)});
  ImGui::Begin("##plot", nullptr, fixed_panel | ImGuiWindowFlags_NoScrollbar);
  const ImVec2 corner = ImGui::GetWindowPos();
  const auto height = static_cast<float>(view.window_height - view.height);
  PlotArea area{{corner.x + 52, corner.y + 30}, {corner.x + width - 28, corner.y + height - 24}};
  const ForceHistory& history = contents.history;
  area.end = history.size() > 0 ? history.latest().time : 0;
  area.limit = std::max(1.08 * history.largest(), 0.5);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  plotLegend(draw, {corner.x + 14, corner.y + 9});
  plotGrid(draw, area);
  draw.PushClipRect(area.from, {area.to.x + 1, area.to.y}, true);
  plotCurves(draw, area, history);
  draw.PopClipRect();
  ImGui::End();
}

void sidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& chosen,
               PictureRequests& requests) {
  ImGui::SetNextWindowPos({static_cast<float>(view.width), 0});
  ImGui::SetNextWindowSize(
      {static_cast<float>(view.window_width - view.width), static_cast<float>(view.window_height)});
  ImGui::Begin("##side", nullptr, fixed_panel);
  choices(contents, chosen, requests);
  numbers(contents);
  lamps(contents.lamps);
  loopNumbers(contents.status);
  latticeChoices(contents, chosen);
  ImGui::End();
}

/// A bar of viridis from bottom to top, `size` large.
void colourBar(ImDrawList& draw, ImVec2 from, ImVec2 size) {
  constexpr int steps = 20;
  const auto colour = [](double place) {
    const std::array<double, 3> rgb = viridis(place);
    return IM_COL32(static_cast<int>(rgb[0]), static_cast<int>(rgb[1]), static_cast<int>(rgb[2]),
                    255);
  };
  const float part = size.y / steps, bottom = from.y + size.y;
  for (int n = 0; n < steps; ++n) {
    const ImU32 low = colour(static_cast<double>(n) / steps), high = colour((n + 1.0) / steps);
    const float y = bottom - part * static_cast<float>(n);
    draw.AddRectFilledMultiColor({from.x, y - part}, {from.x + size.x, y}, high, high, low, low);
  }
}

constexpr float bar_height = 150, bar_width = 12;

/// `labels` from bottom to top at equal distances.
void legendBar(ImDrawList& draw, ImVec2 at, const char* title,
               const std::vector<std::string>& labels) {
  draw.AddText(at, ink, title);
  const ImVec2 bar = {at.x, at.y + 22};
  colourBar(draw, bar, {bar_width, bar_height});
  for (std::size_t n = 0; n < labels.size(); ++n) {
    const float y =
        bar.y + bar_height * (1 - static_cast<float>(n) / static_cast<float>(labels.size() - 1));
    draw.AddText({bar.x + bar_width + 7, y - 7}, ink, labels[n].c_str());
  }
}

void displacementLegend(ImDrawList& draw, ImVec2 at, double full) {
  std::vector<std::string> labels;
  for (int n = 0; n <= 4; ++n) labels.push_back(fmt::format("{:g}", 1e3 * full * n / 4));
  legendBar(draw, at, "displacement, mm", labels);
  const float below = at.y + 22 + bar_height + 14;
  draw.AddText({at.x, below}, faint, "grey: nothing to feel");
}

void latticeLegend(ImDrawList& draw, ImVec2 at, const PanelContents& contents) {
  if (contents.errors) {
    std::vector<std::string> labels;
    for (int n = 0; n <= 3; ++n)
      labels.push_back(fmt::format("{:g}", contents.errors->lowest * std::pow(10, n)));
    legendBar(draw, at, "error bound, N", labels);
    return;
  }
  for (const Tag tag : {Tag::expandable, Tag::terminating, Tag::failed, Tag::unknown}) {
    const std::array<double, 3> rgb = colourOf(tag);
    draw.AddRectFilled({at.x, at.y + 3}, {at.x + 9, at.y + 12},
                       IM_COL32(static_cast<int>(rgb[0]), static_cast<int>(rgb[1]),
                                static_cast<int>(rgb[2]), 255));
    const std::string word(name(tag));
    draw.AddText({at.x + 16, at.y}, ink, word.c_str());
    at.y += 18;
  }
}

/// Text on a light ground, as wide as the view at most; tells where the next may begin.
float banner(ImDrawList& draw, ImVec2 at, float width, ImU32 colour, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width - 20);
  draw.AddRectFilled(at, {at.x + size.x + 20, at.y + size.y + 12}, paper, 4);
  draw.AddRectFilled(at, {at.x + 4, at.y + size.y + 12}, colour, 2);
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + 12, at.y + 6}, colour, text.c_str(),
               nullptr, width - 20);
  return at.y + size.y + 18;
}

constexpr const char* help_text =
    "left drag          turn\n"
    "right, shift drag  move\n"
    "wheel              nearer, farther\n"
    "Ctrl + mouse       moves the tool\n"
    "Ctrl + wheel       tool deeper, higher\n"
    "\n"
    "F      show everything\n"
    "G, L   ghost, lattice\n"
    "M      next method\n"
    "D      next dataset\n"
    "R      release\n"
    "Space  pause, go on\n"
    "F5     reload\n"
    "H      this help\n"
    "Q      quit";

void overlays(const PanelContents& contents, const ViewChoices& view, const Viewport& viewport) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const auto width = static_cast<float>(viewport.width),
             height = static_cast<float>(viewport.height);
  draw.PushClipRect({0, 0}, {width, height});
  for (const ViewLabel& label : contents.labels) {
    const Eigen::Vector3d place = contents.camera.project(label.at);
    if (!(place.z() > 0)) continue;
    const ImVec2 at = {width / 2 + height * static_cast<float>(place.x()) + 12,
                       height / 2 - height * static_cast<float>(place.y()) - 7};
    const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
    draw.AddRectFilled({at.x - 5, at.y - 3}, {at.x + size.x + 5, at.y + size.y + 3}, paper, 3);
    draw.AddText(at, ink, label.text.c_str());
  }
  displacementLegend(draw, {18, height - 222}, contents.full_colour);
  if (view.lattice)
    latticeLegend(draw, {190, contents.errors ? height - 222 : height - 92}, contents);
  float next = 14;
  const float room = width - 28;
  if (!contents.status.trouble.empty())
    next = banner(draw, {14, next}, room, red, contents.status.trouble);
  if (!contents.status.notice.empty())
    next = banner(draw, {14, next}, room, blue, contents.status.notice);
  if (contents.status.paused) next = banner(draw, {14, next}, room, blue, "paused");
  if (view.help) next = banner(draw, {14, next}, room, ink, help_text);
  if (next == 14) draw.AddText({width - 60, 14}, faint, "H: help");
  draw.PopClipRect();
}

std::int32_t following(std::int32_t current, std::size_t count) {
  return static_cast<std::int32_t>((static_cast<std::size_t>(current) + 1) %
                                   std::max<std::size_t>(count, 1));
}

void keys(const PanelContents& contents, ViewChoices& view, PictureRequests& requests) {
  const HapticState& state = contents.state;
  const auto pressed = [&](int key) { return std::ranges::count(contents.keys, key) > 0; };
  if (ImGui::GetIO().WantTextInput) return;
  if (pressed(GLFW_KEY_G)) view.ghost = !view.ghost;
  if (pressed(GLFW_KEY_L)) view.lattice = !view.lattice;
  if (pressed(GLFW_KEY_H)) view.help = !view.help;
  if (pressed(GLFW_KEY_R)) requests.release = true;
  if (pressed(GLFW_KEY_SPACE)) requests.pause = true;
  if (pressed(GLFW_KEY_F5)) requests.reload = true;
  if (pressed(GLFW_KEY_Q)) requests.quit = true;
  if (pressed(GLFW_KEY_M) && contents.methods.size() > 1)
    requests.use = {state.model, following(state.method, contents.methods.size())};
  if (pressed(GLFW_KEY_D) && contents.models.size() > 1)
    requests.use = {following(state.model, contents.models.size()), state.method};
}

}  // namespace

Panels::Panels(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NoMouseCursorChange;
  setStyle();
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
  keys(contents, view, requests);
  sidePanel(contents, viewport, view, requests);
  plot(contents, viewport);
  overlays(contents, view, viewport);
  ImGui::Render();
}

void Panels::render() { ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData()); }

}  // namespace palpate
