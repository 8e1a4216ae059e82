#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <new>
#include <utility>

#include "common/base/error.hpp"
#include "viewer/c_api/palpate.h"

namespace palpate {

/// Text of the last failure of this thread, for palpate_last_error; cut where it does not fit.
using ErrorText = std::array<char, 1024>;
ErrorText& lastErrorText() noexcept;

/// Records a failure of this thread and gives back its status. Does not allocate (the first failure
/// of a thread may: its text comes to be).
template <class... Args>
palpate_status fail(palpate_status status, fmt::format_string<Args...> format,
                    Args&&... args) noexcept {
  ErrorText& text = lastErrorText();
  try {
    const auto written =
        fmt::format_to_n(text.data(), text.size() - 1, format, std::forward<Args>(args)...).size;
    text[std::min(written, text.size() - 1)] = '\0';
  } catch (...) {
    std::strcpy(text.data(), "failed, and the text that says why could not be made");
  }
  return status;
}

template <class... Args>
palpate_status invalid(fmt::format_string<Args...> format, Args&&... args) noexcept {
  return fail(PALPATE_INVALID_ARGUMENT, format, std::forward<Args>(args)...);
}

/// Runs what may throw. An Error is about the file that is being opened: arguments were looked at
/// before.
template <class Work>
palpate_status withoutExceptions(const char* function, Work&& work) noexcept {
  try {
    std::forward<Work>(work)();
    return PALPATE_OK;
  } catch (const std::bad_alloc&) {
    return fail(PALPATE_OUT_OF_MEMORY, "{}: there is not enough memory; prepare fewer methods",
                function);
  } catch (const Error& error) {
    return fail(PALPATE_BAD_FILE, "{}: {}", function, error.what());
  } catch (const std::exception& error) {
    return fail(PALPATE_FAILED, "{}: {}", function, error.what());
  } catch (...) {
    return fail(PALPATE_FAILED, "{}: an exception of an unknown kind", function);
  }
}

}  // namespace palpate
