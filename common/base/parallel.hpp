#pragma once

#include <cstddef>
#include <functional>

namespace palpate {

/// Runs task(0), ..., task(count - 1) on coreCount() threads, including the calling one, and
/// returns when all tasks have ended. Each thread takes the next task as soon as it is free. After
/// an exception no further task starts, and the exception of the task with the lowest number is
/// rethrown. It is the same in every run if the tasks are deterministic.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace palpate
