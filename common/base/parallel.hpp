#pragma once

#include <cstddef>
#include <functional>

namespace palpate {

/// Calls task(0), ..., task(count - 1), on coreCount() threads, the calling one among them, and
/// returns when all have ended. Tasks are taken in order, each by the next thread that is free.
/// When one throws, no further ones begin, and what the first of them threw is thrown.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace palpate
