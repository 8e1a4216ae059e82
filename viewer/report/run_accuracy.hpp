#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "viewer/report/error_measures.hpp"

namespace palpate {

/// A recorded tick that touches, with the exact solution of its touch.
struct ComparedTick {
  double time = 0;        ///< s, since the run began
  double in_contact = 0;  ///< s, since the contact began
  double speed = 0;       ///< m/s, of the tool
  ForceComparison force;  ///< `interpolated` is the recorded force before the guard
};

/// Errors of the compared ticks in one interval of a time or a speed.
struct RunInterval {
  double from = 0, to = 0;  ///< s, or m/s; the last interval may end at infinity
  ErrorMeasures errors;
};

/// Accuracy of the forces in a recorded run, at no more than 1000 ticks, which are spread evenly
/// over all ticks in which one finger touches. Intervals without compared ticks are omitted.
struct RunAccuracy {
  std::filesystem::path recording;
  std::string scene;         ///< name of the scene
  AccuracyTarget target;     ///< that of the scene, or else a default
  std::size_t ticks = 0;     ///< number of recorded ticks
  std::size_t touching = 0;  ///< number of ticks that touch
  std::size_t held = 0;      ///< number of these ticks that a second finger held; not compared
  std::size_t unsolved = 0;  ///< number of chosen ticks without an exact solution
  std::vector<ComparedTick> compared;
  ErrorMeasures all;
  std::vector<RunInterval> times;       ///< tenths of the run
  std::vector<RunInterval> in_contact;  ///< the first 0.3 s of each contact, and the rest
  std::vector<RunInterval> speeds;
};

/// Solves touches of a recorded run exactly, by `palpate solve`, on the path from rest. Takes
/// seconds to minutes. Logs a warning if the run belongs to another version of the scene. Throws
/// Error (bad input) if a file is not what it should be, the run touches another body or nothing,
/// and the errors of the solve (a tool that is not a finger).
RunAccuracy measureRun(const std::filesystem::path& recording, const std::filesystem::path& scene);

}  // namespace palpate
