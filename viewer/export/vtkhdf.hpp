#pragma once

#include <filesystem>

#include "viewer/export/grid.hpp"

namespace palpate {

/// Writes a grid as VTKHDF 1.0 (a static UnstructuredGrid of one partition, in the group /VTKHDF of
/// an HDF5 file; docs.vtk.org, "VTKHDF File Format"), which VTK 9.1 and ParaView 5.11 read; arrays
/// have their `unit` and hash as those of a dataset, and the root group the texts of the grid as
/// attributes. Field data are arrays of one row per tuple. The bytes are a function of the grid.
/// Error on any HDF5 or system failure. One thread at a time (HDF5 is not thread-safe).
void writeVtkHdf(const std::filesystem::path& file, const Grid& grid);

}  // namespace palpate
