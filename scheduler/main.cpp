#include <array>

#include "common/base/program.hpp"
#include "scheduler/build_command.hpp"
#include "scheduler/explain_command.hpp"
#include "scheduler/serve_command.hpp"
#include "scheduler/status_command.hpp"
#include "scheduler/stop_command.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  const std::array verbs = {build_verb, serve_verb, status_verb, stop_verb, explain_verb};
  return runProgram(argc, argv,
                    "Palpate scheduler: decides what is solved next and keeps what workers answer",
                    verbs);
}
