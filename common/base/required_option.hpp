#pragma once

#include <CLI/CLI.hpp>

namespace palpate {

/// Adds a required option or argument to `app`. --help shows `type` as the type of its value, by
/// default the type of `value`.
template <class Value>
CLI::Option* addRequired(CLI::App& app, const char* name, Value& value, const std::string& help,
                         const char* type = nullptr) {
  CLI::Option* const option = app.add_option(name, value, help)->required();
  return type == nullptr ? option : option->type_name(type);
}

}  // namespace palpate
