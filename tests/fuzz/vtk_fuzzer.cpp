#include "tests/fuzz/mesh_bytes.hpp"

namespace palpate::fuzz {
namespace {

void readVtkText(std::string_view bytes) { useMesh(parseVtk(std::string(bytes), "m.vtk")); }

/// corpus/vtk has them as text: nothing in the program writes this format.
std::vector<std::string> noVtkSeeds() { return {}; }

const Registration vtk_fuzzer({"vtk", readVtkText, noVtkSeeds});

}  // namespace
}  // namespace palpate::fuzz
