#pragma once

#include <pthread.h>

#include <string>

namespace palpate {

/// Real-time priorities, in 1..99: above sound servers, below the kernel's own threads. The
/// watchdog must preempt a loop that spins, and the loop must preempt its devices' threads.
inline constexpr int device_priority = 79, loop_priority = 80, watchdog_priority = 81;
/// Highest priority that the system's limits must allow.
inline constexpr int highest_priority = watchdog_priority;

/// Tries SCHED_FIFO in a temporary thread, so nothing else changes. Returns the errno of the
/// refusal, of the priority or of the thread; 0 if granted.
int refusalOfPriority(int wanted);
/// Gives a thread SCHED_FIFO. Returns a sentence about the refusal; empty if granted.
std::string giveRealTime(pthread_t thread, const char* name, int wanted);

}  // namespace palpate
