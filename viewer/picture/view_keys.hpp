#pragma once

#include <array>
#include <vector>

#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// The keys and what they do. The help shows one pair per line.
inline constexpr std::array<std::array<const char*, 2>, 24> key_help = {
    {{"left on the organ", "press, slide"},
     {"wheel while pressing", "deeper, shallower"},
     {"left drag beside it", "turn"},
     {"right drag", "turn"},
     {"middle, Shift drag", "move"},
     {"wheel", "zoom"},
     {"", ""},
     {"arrows, Enter", "slide, press or end"},
     {"Page Down, Up", "deeper, shallower"},
     {"R, Esc", "take the tool out"},
     {"T", "leave a finger here, let it go"},
     {"Shift arrows, + -", "turn, zoom"},
     {"", ""},
     {"F", "show all, reset colours"},
     {"G, L", "ghost, lattice"},
     {"E", "lattice by error, by tag"},
     {"C", "next colouring"},
     {"B", "compare datasets"},
     {"M", "next method"},
     {"D", "next dataset"},
     {"Space", "pause, resume"},
     {"F5", "reload"},
     {"H", "this help"},
     {"Q", "quit"}}};
/// Handles the keys that were pressed since the last frame: changes `choices` and adds to
/// `requests`. Skips datasets and methods that are not prepared yet.
void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
/// Adds the keys' input for the hand and the camera. keys, strokes: as the Window returns them.
void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input);

}  // namespace palpate
