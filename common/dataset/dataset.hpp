#pragma once

#include <functional>
#include <memory>

#include "common/dataset/stored_body.hpp"
#include "common/problem/problem.hpp"
#include "common/space/space_table.hpp"

namespace palpate {
namespace hdf5 {
struct ArrayInfo;
}

/// Returns the nodal fields of a solved point, for sealDataset(). Error if they cannot be read.
using FieldsSource = std::function<NodalFields(std::size_t space, std::int32_t point)>;

/// Writes a sealed dataset. The data is first written to FILE.tmp, which is closed, re-opened,
/// checked against its hashes, fsynced and renamed to FILE; then the directory is fsynced. If the
/// process is killed at any time, FILE is absent or a complete dataset, old or new. The bytes
/// depend on the arguments alone (no time stamps). docs/dataset.md describes the layout.
///
/// `spaces` holds one entry per entry of problem.active, in the same order and with the same
/// patches. The lattice of each must be the uniform lattice of the problem, to which points may
/// have been added. Each must have one record per point and pass faultOf(). Otherwise nothing is
/// written, and an Error (faultOf) or std::logic_error is thrown.
///
/// `fields` is called once for every solved point, in order of space and point. It must return the
/// fields with the id in the point's record (PointRecord::fields). scene.storage decides which part
/// of them is stored. Fields of probes are not stored. `partial` marks an unfinished build
/// (Dataset::isPartial).
///
/// Sealing takes a few MB of memory, and 36 bytes per point. Error on any HDF5 or system failure;
/// FILE.tmp is then removed. One thread at a time (HDF5 is not thread-safe).
void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const SpaceRowsList& spaces, const std::string& kernel_family,
                 const FieldsSource& fields, bool partial = false);

/// A sealed dataset, opened for reading. Construction reads and verifies everything but the nodal
/// fields, which are read and verified on demand. Any thread may read the tables. Other calls are
/// for one thread at a time (HDF5 is not thread-safe). Moving a Dataset invalidates references to
/// its members.
class Dataset {
 public:
  /// Opens and verifies `file`. Error if the file is missing, truncated, not a Palpate dataset or
  /// of an unsupported major version, or if an array does not match its hash. The message names the
  /// file and the array.
  explicit Dataset(const std::filesystem::path& file);
  ~Dataset();
  Dataset(Dataset&&) noexcept;
  Dataset& operator=(Dataset&&) noexcept;

  const std::filesystem::path& file() const { return file_; }  ///< path as given to the constructor
  /// Hash of all arrays and the scene. Datasets with equal content have equal ids.
  ContentId contentId() const { return content_id_; }
  ContentId buildId() const { return build_id_; }  ///< problemId of the solved problem
  /// Returns whether the dataset was sealed before its build was finished. Some points may then be
  /// unknown, and refinement incomplete.
  bool isPartial() const { return partial_; }
  /// Names of the kernels that computed the results (arithmeticOf), such as "avx512/SkylakeX".
  const std::string& kernelFamily() const { return kernel_family_; }
  const std::string& sceneToml() const { return scene_toml_; }  ///< resolved scene as text
  const Scene& scene() const { return scene_; }                 ///< parsed from sceneToml()
  /// The mesh, quadratic if the displacement is P2. It has no groups, because none are stored.
  const Mesh& mesh() const { return body_.mesh; }
  const std::vector<std::int32_t>& fixedNodes() const { return body_.fixed; }  ///< sorted
  /// One space per active node, in scene order; probe places of areas are separate (probePlaces).
  const std::vector<SpaceTable>& spaces() const { return spaces_; }
  /// One space per probe place of an area, in scene order. Each holds the rest position and one
  /// probe (ActivePatch::probe).
  const std::vector<SpaceTable>& probePlaces() const { return probe_places_; }
  /// Vertices on the surface, sorted.
  const std::vector<std::int32_t>& surfaceNodes() const { return body_.surface; }
  /// Nodes with stored displacements, sorted: the surface nodes, or all nodes.
  const std::vector<std::int32_t>& storedNodes() const { return body_.stored; }

  /// Returns the stored nodal fields of a solved point: three displacements per stored node, and
  /// pressures if all nodes are stored.
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Returns the stored fields of the surface nodes at every point of a space: displacements,
  /// metres, [point][surface node][axis], and pressures, Pa, [point][surface node]. Pressures are
  /// empty if the dataset stores none (storedPressures). Values are NaN at points that are not
  /// solved.
  NodalFields surfaceFields(std::size_t space) const;
  /// Returns path, type, shape, hash and stored size of every array of the file.
  const std::vector<hdf5::ArrayInfo>& arrays() const;
  /// Reads and verifies every array, also the nodal fields. Error names the first damaged array.
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

/// Logs a warning with the number of unknown points if the dataset is partial.
void warnIfPartial(const Dataset& dataset);

}  // namespace palpate
