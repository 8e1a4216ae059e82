#include <array>

#include "common/base/program.hpp"
#include "common/dataset/hdf5_handle.hpp"
#include "viewer/export/export_command.hpp"
#include "viewer/query/query_command.hpp"
#include "viewer/report/report_command.hpp"
#include "viewer/share/share_command.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  hdf5::leaveOpenFilesAtExit();
  const std::array verbs = {query_verb, report_verb, export_verb, share_verb};
  return runProgram(argc, argv, "Answers from datasets: forces, reports, files and pages", verbs);
}
