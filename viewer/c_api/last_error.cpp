#include "viewer/c_api/last_error.hpp"

namespace palpate {

ErrorText& lastErrorText() noexcept {
  static thread_local ErrorText text{};
  return text;
}

}  // namespace palpate

const char* palpate_last_error() { return palpate::lastErrorText().data(); }
