#include <array>

#include "common/base/program.hpp"
#include "common/dataset/hdf5_handle.hpp"
#include "viewer/devices/device_command.hpp"
#include "viewer/doctor.hpp"
#include "viewer/export/export_command.hpp"
#include "viewer/query_command.hpp"
#include "viewer/report/report_command.hpp"
#include "viewer/share/share_command.hpp"
#include "viewer/view_command.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  hdf5::leaveOpenFilesAtExit();
  const std::array verbs = {viewVerb(),  queryVerb(),  reportVerb(), exportVerb(),
                            shareVerb(), deviceVerb(), doctorVerb()};
  return runProgram(argc, argv,
                    "Palpate's haptic side: lets a hand feel datasets, answers with forces", verbs);
}
