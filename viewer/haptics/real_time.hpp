#pragma once

#include <pthread.h>

#include <string>

namespace palpate {

/// Real-time priorities, from 1 to 99: above sound servers, below the kernel's own threads. The
/// watchdog must be able to preempt a loop that spins, and the loop must be able to preempt the
/// threads of its device.
inline constexpr int device_priority = 79, loop_priority = 80, watchdog_priority = 81;
/// Highest priority that is used; the limits of the system must allow it.
inline constexpr int highest_priority = watchdog_priority;

/// Returns 0 if the system grants SCHED_FIFO with this priority, otherwise the errno of the
/// refusal. Tries it in a temporary thread, so nothing else changes; if that thread cannot be
/// created, returns the errno of that failure.
int refusalOfPriority(int wanted);
/// Gives a thread SCHED_FIFO. Returns a sentence that explains the refusal; empty if granted.
std::string giveRealTime(pthread_t thread, const char* name, int wanted);

}  // namespace palpate
