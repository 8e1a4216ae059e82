#include <array>

#include "common/program.hpp"
#include "viewer/devices/device_command.hpp"
#include "viewer/query_command.hpp"
#include "viewer/report_command.hpp"

int main(int argc, char** argv) {
  const std::array verbs = {palpate::queryVerb(), palpate::reportVerb(), palpate::deviceVerb()};
  return palpate::runProgram(argc, argv, "Palpate's haptic side: reads datasets and answers with forces",
                             verbs);
}
