#pragma once

#include <cstddef>
#include <functional>

namespace palpate {

/// Runs task(0), ..., task(count - 1) on coreCount() threads, including the calling one, and
/// returns when all tasks have ended. Each thread takes the next task as soon as it is free. After
/// an exception no further task starts. If several tasks throw, the exception of the task with the
/// lowest number is rethrown. Deterministic tasks therefore give the same exception in every run.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace palpate
