#include <array>

#include "common/base/program.hpp"
#include "common/dataset/hdf5_handle.hpp"
#include "viewer/devices/device_command.hpp"
#include "viewer/doctor.hpp"
#include "viewer/touch_command.hpp"
#include "viewer/view_command.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  hdf5::leaveOpenFilesAtExit();
  const std::array verbs = {view_verb, touch_verb, device_verb, doctor_verb};
  return runProgram(argc, argv, "Palpate's haptic client: lets a hand feel datasets", verbs);
}
