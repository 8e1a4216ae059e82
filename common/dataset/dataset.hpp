#pragma once

#include <functional>
#include <memory>

#include "common/dataset/stored_body.hpp"
#include "common/problem/problem.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Gives the nodal fields of a solved point while a dataset is sealed. Throws Error when they
/// cannot be read.
using FieldsSource = std::function<NodalFields(std::size_t space, std::int32_t point)>;

/// Writes a sealed dataset: aside as FILE.tmp, closed, re-opened and checked against the hashes,
/// fsynced, renamed over FILE, directory fsynced. At any kill FILE is the old one, the new one or
/// absent, never a part. The bytes are a function of the arguments alone (no time stamps). Layout:
/// docs/dataset.md.
///
/// `spaces` has one per problem.active, in that order and with those patches, each on the lattice
/// of problem.scene (and what was added to it), with one record per point of it and without
/// faultOf; else Error, and nothing is written. Beside what they hold sealing takes some MB, and 36
/// bytes a point. `fields` is asked for every solved point once, in order of space and point, and
/// must give what its record names; scene.storage says what is kept of it. Of probes no fields are
/// kept. `partial`: the build is not done (Dataset::isPartial). Error on any HDF5 or system
/// failure; FILE.tmp is then removed. One thread at a time (HDF5 is not thread-safe).
void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const SpaceRowsList& spaces, const std::string& kernel_family,
                 const FieldsSource& fields, bool partial = false);

/// A sealed dataset, opened for reading. Everything but the nodal fields is in memory after
/// construction, verified; those are read, and verified, when asked for. One thread at a time (HDF5
/// is not thread-safe); the tables may be read by any thread. References to what it holds end when
/// it is moved.
class Dataset {
 public:
  /// Opens and verifies `file`. Error when it is missing, truncated, not a Palpate dataset, of
  /// another major version, or when an array that is read does not match its hash; the message
  /// names file and array.
  explicit Dataset(const std::filesystem::path& file);
  ~Dataset();
  Dataset(Dataset&&) noexcept;
  Dataset& operator=(Dataset&&) noexcept;

  const std::filesystem::path& file() const { return file_; }  ///< as it was opened
  /// Over all arrays and the scene: equal for equal results.
  ContentId contentId() const { return content_id_; }
  ContentId buildId() const { return build_id_; }  ///< problemId of the problem it answers
  /// Sealed before its build was done: points are unknown, or refinement is not at its end.
  bool isPartial() const { return partial_; }
  const std::string& kernelFamily() const { return kernel_family_; }  ///< of its workers
  const std::string& sceneToml() const { return scene_toml_; }        ///< resolved scene
  const Scene& scene() const { return scene_; }                       ///< read from that text
  /// Quadratic with P2 displacement; groups are not stored.
  const Mesh& mesh() const { return body_.mesh; }
  const std::vector<std::int32_t>& fixedNodes() const { return body_.fixed; }  ///< sorted
  /// One per active node, in the order of the scene; not those that only measure an area.
  const std::vector<SpaceTable>& spaces() const { return spaces_; }
  /// Where areas are measured, in the order of the scene: the origin and one probe each
  /// (ActivePatch::probe).
  const std::vector<SpaceTable>& probePlaces() const { return probe_places_; }
  /// The vertices on the surface, sorted: what is seen.
  const std::vector<std::int32_t>& surfaceNodes() const { return body_.surface; }
  /// The nodes whose displacements are kept, sorted: those of the surface, or all.
  const std::vector<std::int32_t>& storedNodes() const { return body_.stored; }

  /// What is kept of the nodal fields of a solved point: three displacements per stored node, and
  /// pressures when all nodes are stored.
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// What is kept of the surface nodes in every point of a space: displacements, metres,
  /// [point][surface node][axis], and pressures, Pa, [point][surface node], where they are stored
  /// (storedPressures), else none. NaN in points that are not solved.
  NodalFields surfaceFields(std::size_t space) const;
  /// Reads and verifies every array, the nodal fields too. Error names the first damaged one.
  void verifyAll() const;

 private:
  struct Input;

  std::filesystem::path file_;
  std::unique_ptr<Input> input_;
  std::string scene_toml_;
  Scene scene_;
  StoredBody body_;
  std::vector<SpaceTable> spaces_, probe_places_;
  ContentId content_id_, build_id_;
  bool partial_ = false;
  std::string kernel_family_;
};

/// Logs a warning, with how many points are unknown, when it is partial.
void warnIfPartial(const Dataset& dataset);

}  // namespace palpate
