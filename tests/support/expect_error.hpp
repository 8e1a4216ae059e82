#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "common/base/error.hpp"

namespace palpate::test {

/// Runs `action` and expects an Error of the given exit code whose message contains every one of
/// `words`.
template <class Action>
void expectError(ExitCode code, Action&& action, std::initializer_list<std::string> words) {
  try {
    action();
    ADD_FAILURE() << "no error, where one that says \"" << *words.begin() << "\" was expected";
  } catch (const Error& error) {
    EXPECT_EQ(error.exitCode(), code) << error.what();
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "\"" << word << "\" is not in: " << error.what();
  }
}

/// expectError for invalid input by the user (exit code 2).
template <class Action>
void expectBadInput(Action&& action, std::initializer_list<std::string> words) {
  expectError(ExitCode::usage, action, words);
}

}  // namespace palpate::test
