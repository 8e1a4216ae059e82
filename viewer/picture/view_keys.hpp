#pragma once

#include <vector>

#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"

namespace palpate {

/// Help text for keys and mouse, one line per entry.
extern const char* const key_help;
/// Handles the keys that were pressed since the last frame: changes `choices` and adds to
/// `requests`. Skips datasets and methods that are not prepared yet.
void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
/// Adds the keys' input for the hand and the camera. keys, strokes: as the Window returns them.
void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input);

}  // namespace palpate
