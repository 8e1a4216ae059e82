#include "common/base/assertion.hpp"
#include "common/base/program.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "common/dataset/dataset_format.hpp"
#include "common/interpolation/branch_check.hpp"

namespace palpate {
namespace {

void checkSpaces(const std::string& file, const Problem& problem, const SpaceRowsList& spaces) {
  PALPATE_ASSERT(!spaces.empty() && spaces.size() == problem.active.size(),
                 "each active node must have a space");
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    const Lattice &lattice = spaces[s]->lattice(),
                  expected = uniformLattice(problem.scene, problem.active[s]);
    PALPATE_ASSERT(spaces[s]->patch() == problem.active[s],
                   "a space must have the patch of its active node");
    PALPATE_ASSERT(
        lattice.radius() == expected.radius() && lattice.spacing() == expected.spacing() &&
            lattice.divisions() == expected.divisions() && lattice.uniformSize() == expected.size(),
        "a space must begin with the lattice of the scene");
    PALPATE_ASSERT(spaces[s]->points() >= lattice.uniformSize(),
                   "each point of the lattice must have a record");
    if (const std::string fault = faultOf(*spaces[s]); !fault.empty())
      throw failure("{}: space \"{}\": {}", file, spaces[s]->patch().name, fault);
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
  checkSpaces(file.string(), problem, spaces);
  replaceFile(file, [&](const std::filesystem::path& aside) {
    const ContentId content = writeDataset(aside, problem, spaces, kernel_family, fields, partial);
    // Read the new file and check it before it replaces an older one.
    if (verifiedContent(aside) != content)
      throw failure("{}: the data read back differs from the data written", aside.string());
  });
}

}  // namespace palpate
