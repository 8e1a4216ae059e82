#pragma once

#include <vector>

#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"

namespace palpate {

/// Help for keys and mouse, one line each.
extern const char* const key_help;
/// Changes `choices` and adds to `requests` for the keys pressed since the last picture. Skips
/// datasets and methods that are not prepared yet.
void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
/// Adds the input of keys to the hand and the camera. keys, strokes: from the Window.
void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input);

}  // namespace palpate
