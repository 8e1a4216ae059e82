#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/configuration.hpp"
#include "common/lattice.hpp"
#include "common/problem.hpp"
#include "common/rbf_weights.hpp"
#include "common/tag.hpp"

namespace palpate {

/// One recorded transition that failed: point `target` could not be reached from `parent`.
struct FailedAttempt {
  std::int32_t target = -1;  ///< lattice numbers
  std::int32_t parent = -1;
  Failure failure;
};

/// What is known of one lattice point; the rows of a configuration space.
struct PointRecord {
  Tag tag = Tag::unknown;
  Cause cause = Cause::none;  ///< when failed: of the attempt that got furthest, unreachable without one
  std::int32_t parent =
      -1;  ///< lattice number it was solved from; the origin is its own parent; -1 when not solved
  Equilibrium equilibrium;  ///< valid when expandable or terminating
  double residual = 0;      ///< N
  Cost cost;                ///< `seconds` is not stored
  /// Of its NodalFields, all nodes in float32, which transitions from it start with; all zero when not
  /// solved. A dataset may keep less of them (Storage).
  ContentId fields;
};

/// An exact solution at a position off the lattice. No interpolation may use it: it is there to measure
/// interpolations.
struct Probe {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  PointRecord record;  ///< its parent is a lattice point; never unknown in a complete build
};

/// One configuration space without the bulky fields. points[n] belongs to lattice number n.
struct SpaceTable {
  ActivePatch patch;
  Lattice lattice;
  std::vector<LatticeCell> splits;  ///< cells that were split into eight, sorted by (level, lowest)
  std::vector<PointRecord> points;
  std::vector<FailedAttempt> attempts;  ///< sorted by (target, order in which they were tried); no probes
  std::vector<Probe> probes;
  /// inconsistentEdges of this space (branch_check.hpp), as they were when the dataset was sealed;
  /// sealDataset finds them itself.
  std::vector<LatticeEdge> inconsistent_edges;
  /// Weights of r, r with tail, r^3, r^3 with tail, of these points, from a dataset; sealDataset solves them
  /// itself. Empty where no point is solved, or more than most_stored_rbf_points.
  std::vector<RbfWeights> rbf;
};

/// Factorising for more points would hold sealing up; who wants their weights solves them (solveRbfWeights).
inline constexpr std::size_t most_stored_rbf_points = 2000;

/// Largest force of a terminating point that cells are interpolated with, in largest forces of the expandable
/// points. Beyond it an element beside the tool is being crushed: the force is tens to thousands of times
/// what a device renders, and a polynomial that meets it is wrong in the whole cell.
inline constexpr double largest_force_share = 3;

/// By lattice number, whether cells are interpolated with the point: it is solved and, if it is terminating,
/// within largest_force_share. The others are continued from their neighbours, as if they had failed.
std::vector<bool> interpolatedPoints(const SpaceTable& space);

/// What of `space` contradicts itself, as a clause for errors ("probe 3 lies outside of the workspace");
/// empty when nothing does. Looked at are numbers that name points, cells and edges, and positions.
std::string faultOf(const SpaceTable& space);

/// Gives the nodal fields of a solved point while a dataset is sealed. Throws Error when they cannot be read.
using FieldsSource = std::function<NodalFields(std::size_t space, std::int32_t point)>;

/// Writes a sealed dataset: aside as FILE.tmp, closed, re-opened and checked against the hashes, fsynced,
/// renamed over FILE, directory fsynced. At any kill FILE is the old one, the new one or absent, never a
/// part. The bytes are a function of the arguments alone (no time stamps). Layout: docs/dataset.md.
///
/// `spaces` has one table per problem.active, in that order and with those patches, each on the lattice of
/// problem.scene (and what was added to it), with one record per point of it and without faultOf; else Error,
/// and nothing is written. `fields` is asked for every solved point once, in order of space and point, and
/// must give what its record names; scene.storage says what is kept of it. Of probes no fields are kept.
/// Error on any HDF5 or system failure; FILE.tmp is then removed. One thread at a time (HDF5 is not
/// thread-safe).
void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const std::vector<SpaceTable>& spaces, const std::string& kernel_family,
                 const FieldsSource& fields);

/// A sealed dataset, opened for reading. Everything but the nodal fields is in memory after construction,
/// verified; those are read, and verified, when asked for. One thread at a time (HDF5 is not thread-safe);
/// the tables may be read by any thread.
class Dataset {
 public:
  /// Opens and verifies `file`. Error when it is missing, truncated, not a Palpate dataset, of another major
  /// version, or when an array that is read does not match its hash; the message names file and array.
  explicit Dataset(const std::filesystem::path& file);
  ~Dataset();
  Dataset(Dataset&&) noexcept;
  Dataset& operator=(Dataset&&) noexcept;

  const std::filesystem::path& file() const;
  ContentId contentId() const;  ///< over all arrays and the scene: equal for equal results
  ContentId buildId() const;    ///< problemId of the problem it answers
  const std::string& kernelFamily() const;
  const std::string& sceneToml() const;  ///< resolved scene
  const Scene& scene() const;
  const Mesh& mesh() const;  ///< quadratic with P2 displacement; groups are not stored
  const std::vector<std::int32_t>& fixedNodes() const;  ///< sorted
  const std::vector<SpaceTable>& spaces() const;
  /// The vertices on the surface, sorted: what is seen.
  const std::vector<std::int32_t>& surfaceNodes() const;
  /// The nodes whose displacements are kept, sorted: those of the surface, or all.
  const std::vector<std::int32_t>& storedNodes() const;

  /// Number of the space of the active node `name`; Error (bad input) that lists the names there are.
  std::size_t spaceNamed(const std::string& name) const;
  /// What is kept of the nodal fields of a solved point: three displacements per stored node, and pressures
  /// when all nodes are stored.
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Displacements of the surface nodes in every point of a space, metres: [point][surface node][axis], NaN
  /// in points that are not solved.
  std::vector<float> surfaceDisplacements(std::size_t space) const;
  /// Reads and verifies every array, the nodal fields too. Error names the first damaged one.
  void verifyAll() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
