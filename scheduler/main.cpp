#include <array>

#include "common/dataset/hdf5_handle.hpp"
#include "scheduler/verbs/verbs.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  hdf5::leaveOpenFilesAtExit();
  const std::array verbs = {build_verb,   serve_verb,  status_verb,      stop_verb,     fleet_verb,
                            seal_verb,    pause_verb,  resume_verb,      priority_verb, retry_verb,
                            explain_verb, events_verb, check_state_verb, key_verb};
  return runProgram(
      argc, argv,
      "Palpate scheduler: chooses the next transitions to solve and stores their results", verbs);
}
