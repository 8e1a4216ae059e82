#pragma once

#include "viewer/export/grid.hpp"

// VTK's XML formats. Numbers are raw bytes behind the text ("appended"), not compressed: what VTK,
// ParaView and meshio all read, the fastest way. A parser of XML alone cannot, because of them.

namespace palpate {

/// The bytes of a .vtu file. Arrays have their unit, and the element VTKFile the texts of the grid
/// as attributes, which readers pass over.
std::string vtuBytes(const Grid& grid);

/// One file of a series and the time that it stands for.
struct SeriesFile {
  double time = 0;
  std::string file;  ///< relative to the .pvd
};

/// The text of a .pvd file: ParaView's list of the files of a series.
std::string pvdText(const std::vector<SeriesFile>& series);

/// Text as an attribute of XML may hold it: markup escaped, control characters, which XML has no
/// words for, as ?.
std::string xmlText(std::string_view text);

}  // namespace palpate
