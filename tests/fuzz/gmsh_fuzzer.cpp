#include "tests/fuzz/mesh_bytes.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

void readGmshText(std::string_view bytes) { useMesh(parseGmsh(std::string(bytes), "m.msh")); }

std::vector<std::string> gmshSeeds() {
  const test::TemporaryDirectory directory;
  const Mesh mesh = test::cubeMesh(0.1, 1);
  test::writeGmsh22(mesh, directory / "2.msh");
  test::writeGmsh41(mesh, directory / "4.msh");
  return {bytesIn(directory / "2.msh"), bytesIn(directory / "4.msh")};
}

const Registration gmsh_fuzzer({"gmsh", readGmshText, gmshSeeds});

}  // namespace
}  // namespace palpate::fuzz
