#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// The verb `touch` of palpate-viewer, which has palpate-worker make the mesh and the scene of an
/// organ in the current folder, unless they exist, and runs view() (view_command.hpp) with the
/// scene. The verb throws Error (bad input) for wrong options before it makes anything, for an
/// organ file that is newer than its mesh or scene, and the errors of view(). If palpate-worker
/// fails, the verb returns its exit code.
extern const Verb touch_verb;

}  // namespace palpate
