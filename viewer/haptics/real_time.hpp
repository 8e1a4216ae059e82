#pragma once

#include <pthread.h>

#include <string>

namespace palpate {

/// Real-time priorities, of 1..99: above sound servers, below the kernel's own threads. The
/// watchdog must get past a loop that spins, and the loop past what it reads from.
inline constexpr int device_priority = 79, loop_priority = 80, watchdog_priority = 81;
/// What limits must allow.
inline constexpr int highest_priority = watchdog_priority;

/// Asks for SCHED_FIFO on a thread of its own, so that nothing else changes. Returns an errno, 0
/// where it is granted; also where the system refuses the thread.
int refusalOfPriority(int wanted);
/// Gives a thread SCHED_FIFO. Returns a sentence about the refusal; empty where there is none.
std::string giveRealTime(pthread_t thread, const char* name, int wanted);

}  // namespace palpate
