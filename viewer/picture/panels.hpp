#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/stage.hpp"

struct GLFWwindow;

namespace palpate {

/// The panels beside and over the view (Dear ImGui), with keys and buttons. Used by the thread of
/// the Window only; must be destroyed before it.
class Panels {
 public:
  explicit Panels(GLFWwindow* window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Begins a picture and updates the input.
  void begin();
  /// Returns the part of the window without panels, pixels. Call after begin().
  Viewport view() const;
  /// Lays out the panels. Changes `choices` and adds to `requests` by the user's input.
  void build(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
  /// Draws the layout of build(); may be repeated.
  void render();

 private:
  void fitScreen();

  GLFWwindow* window_;
  double scale_ = 0, units_ = 0;  ///< as for setPanelStyle()
};

}  // namespace palpate
