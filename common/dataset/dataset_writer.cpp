#include "common/base/program.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "common/dataset/dataset_format.hpp"
#include "common/interpolation/branch_check.hpp"

namespace palpate {
namespace {

void checkArguments(const std::string& file, const Problem& problem, const SpaceRowsList& spaces) {
  if (spaces.empty() || spaces.size() != problem.active.size())
    throw failure("{}: the dataset would have {} spaces for {} active nodes", file, spaces.size(),
                  problem.active.size());
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    const ActivePatch &given = spaces[s]->patch(), &active = problem.active[s];
    const Lattice expected = uniformLattice(problem.scene, active);
    if (given != active)
      throw failure("{}: space {} is \"{}\", but the active node of the scene is \"{}\"", file, s,
                    given.name, active.name);
    const Lattice& lattice = spaces[s]->lattice();
    if (lattice.radius() != expected.radius() || lattice.spacing() != expected.spacing() ||
        lattice.divisions() != expected.divisions() || lattice.uniformSize() != expected.size())
      throw failure(
          "{}: space \"{}\": its lattice (radius {} m, spacing {} m) "
          "is not that of the scene (radius {} m, spacing {} m)",
          file, given.name, lattice.radius(), lattice.spacing(), expected.radius(),
          expected.spacing());
    if (spaces[s]->points() < lattice.uniformSize())
      throw failure("{}: space \"{}\": has {} points, but its lattice has {}", file, given.name,
                    spaces[s]->points(), lattice.uniformSize());
    if (const std::string fault = faultOf(*spaces[s]); !fault.empty())
      throw failure("{}: space \"{}\": {}", file, given.name, fault);
  }
}

/// Computes the inconsistent edges of each space, which the dataset stores too.
std::vector<std::vector<LatticeEdge>> inconsistentEdgesOf(const SpaceRowsList& spaces) {
  std::vector<std::vector<LatticeEdge>> jumps;
  for (const auto& space : spaces)
    jumps.push_back(inconsistentEdges(space->lattice(), space->splits(), [&](std::int32_t n) {
      return n < space->points() ? space->equilibrium(n) : nullptr;
    }));
  return jumps;
}

/// Writes the attributes of the root group and returns the content hash.
ContentId writeRoot(hdf5::Writer& out, const Problem& problem, const std::string& kernel_family,
                    bool partial) {
  const std::string scene = resolvedToml(problem.scene);
  const ContentId content = layout::contentHash(scene, out.arrays());
  const std::array<std::int32_t, 2> version_numbers = {layout::major_version,
                                                       layout::minor_version};
  out.setText("/", layout::format_attribute, layout::format);
  out.setIntegers("/", layout::version_attribute, version_numbers);
  out.setText("/", layout::generator_attribute, std::string("palpate ") + version());
  out.setText("/", "units", layout::units);
  out.setText("/", layout::kernel_attribute, kernel_family);
  out.setText("/", layout::scene_attribute, scene);
  out.setText("/", layout::build_attribute, problemId(problem).hex());
  out.setText("/", layout::content_attribute, content.hex());
  if (partial) out.setIntegers("/", layout::partial_attribute, std::array<std::int32_t, 1>{1});
  return content;
}

/// Writes groups, arrays and attributes in a fixed order, which determines the bytes of the file.
ContentId writeDataset(const std::filesystem::path& file, const Problem& problem,
                       const SpaceRowsList& spaces, const std::string& kernel_family,
                       const FieldsSource& fields, bool partial) {
  hdf5::Writer out(file);
  writeMesh(out, problem);
  writeSpaces(out, spaces, inconsistentEdgesOf(spaces));
  writeFields(out, problem, spaces, fields);
  const ContentId content = writeRoot(out, problem, kernel_family, partial);
  out.close();
  return content;
}

}  // namespace

void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const SpaceRowsList& spaces, const std::string& kernel_family,
                 const FieldsSource& fields, bool partial) {
  // Check this first. Otherwise the rename at the end would fail, perhaps after hours.
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw badInput("{}: is a directory; give the dataset a file name", file.string());
  checkArguments(file.string(), problem, spaces);
  replaceFile(file, [&](const std::filesystem::path& aside) {
    const ContentId content = writeDataset(aside, problem, spaces, kernel_family, fields, partial);
    // Read the new file and check it before it replaces an older one.
    if (verifiedContent(aside) != content)
      throw failure("{}: the data read back differs from the data written", aside.string());
  });
}

}  // namespace palpate
