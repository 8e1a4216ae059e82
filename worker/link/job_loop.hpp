#pragma once

#include "worker/elements/kernel_family.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

/// Runs the solver thread: takes jobs from the mailbox and solves their targets one after another,
/// until the mailbox is closed. Consecutive jobs of one problem share one solver, with its analysis
/// and memory. A failed solve is a result, not an error. An exception ends the loop and is reported
/// through the mailbox.
void solveJobs(Mailbox& mailbox, const ElementKernels& kernels);

}  // namespace palpate
