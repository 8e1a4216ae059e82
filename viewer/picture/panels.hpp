#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/stage.hpp"

struct GLFWwindow;

namespace palpate {

/// The panels beside and over the view (Dear ImGui), keys and buttons. Belongs to the thread of the
/// Window, must go before it.
class Panels {
 public:
  explicit Panels(GLFWwindow* window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Begins a picture: input is up to date afterwards.
  void begin();
  /// The part of the window that panels leave free, pixels. After begin().
  Viewport view() const;
  /// Lays the panels out. Changes `choices` and adds to `requests` as the person asks.
  void build(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
  /// Draws what build() laid out; again after that, the same.
  void render();

 private:
  void fitScreen();

  GLFWwindow* window_;
  double scale_ = 0, units_ = 0;  ///< of the style, setPanelStyle
};

}  // namespace palpate
