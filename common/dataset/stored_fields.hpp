#pragma once

#include <optional>

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/problem/problem.hpp"
#include "common/space/space_table.hpp"

/// The nodal fields in a dataset: what scene.storage keeps of them, in the rows of /points.
namespace palpate {

/// Writes the fields of the points of all spaces, in that order, as the scene's [storage] says.
class FieldsWriter {
 public:
  /// `n_rows`: points of all spaces together. `out` must outlive this object.
  FieldsWriter(hdf5::Writer& out, const Problem& problem, std::size_t n_rows);
  void write(const NodalFields& fields);  ///< of the next point, all nodes
  void skip();                            ///< the next point, which is not solved
  void finish();                          ///< after the last point

 private:
  hdf5::Writer& out_;
  std::vector<std::int32_t> stored_;
  std::optional<hdf5::RowWriter<float>> floats_, pressures_;
  std::optional<hdf5::RowWriter<std::int16_t>> integers_;
  std::vector<float> steps_;  ///< m, of the rows of integers_
  std::vector<ContentId> hashes_;
};

/// Reads them back, each row compared with its hash.
class FieldsReader {
 public:
  /// Error that names the array when shapes are not those of the scene, the mesh and the spaces.
  /// `in` and `spaces` must outlive this object.
  FieldsReader(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh,
               const std::vector<SpaceTable>& spaces);

  /// Displacements (metres) of the stored nodes, and pressures (Pa) where they are kept, of `count`
  /// points from `first` on, one after the other; NaN in points that are not solved. Error that
  /// names point and array when a row is damaged.
  NodalFields read(std::size_t space, std::size_t first, std::size_t count) const;

 private:
  const hdf5::Reader& in_;
  const std::vector<SpaceTable>& spaces_;
  std::vector<std::size_t> first_rows_;  ///< of the spaces
  std::size_t n_values_, n_pressures_;   ///< per row
  bool quantized_;
  std::vector<ContentId> hashes_;
  std::vector<float> steps_;  ///< m
};

}  // namespace palpate
