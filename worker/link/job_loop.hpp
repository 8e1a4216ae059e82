#pragma once

#include "worker/elements/kernel_family.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

/// The solver thread: takes jobs from the mailbox and solves their targets one after another until
/// it is closed. The solver of a problem (its analysis, its memory) is kept from job to job. What
/// cannot be solved is a failed result, not an error; an exception ends the loop and is left in the
/// mailbox.
void solveJobs(Mailbox& mailbox, const ElementKernels& kernels);

}  // namespace palpate
