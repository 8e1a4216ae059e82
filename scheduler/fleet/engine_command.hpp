#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace palpate {

/// What became of a program that was run.
struct Ran {
  int exit_code = -1;
  std::string out, err;  ///< what it wrote to stdout and stderr
};

/// Runs a program of an engine (sbatch, ...), looked for in $PATH, with `input` at its stdin, and
/// waits for its end. Error when it cannot be started, names the package it is in when it is not
/// installed; when a signal ends it, or it takes longer than `patience` and is killed.
Ran runOfEngine(const std::vector<std::string>& words, const std::string& input,
                std::chrono::seconds patience = std::chrono::seconds(60));

}  // namespace palpate
