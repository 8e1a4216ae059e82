#pragma once

#include "viewer/export/grid.hpp"

// VTK's XML formats. Numbers are raw bytes after the text ("appended"), not compressed. This is the
// fastest variant that VTK, ParaView and meshio all read. The bytes make the file unreadable for a
// general XML parser.

namespace palpate {

/// Returns the bytes of a .vtu file. The units of arrays and the texts of the grid are attributes
/// (of arrays and of VTKFile) that readers ignore.
std::string vtuBytes(const Grid& grid);

/// A file of a series, and the time at which ParaView shows it.
struct SeriesFile {
  double time = 0;
  std::string file;  ///< relative to the .pvd
};

/// Returns the text of a .pvd file, in which ParaView finds the files of a series.
std::string pvdText(const std::vector<SeriesFile>& series);

/// Escapes markup for an XML attribute, and replaces control characters, which XML cannot
/// represent, by ?.
std::string xmlText(std::string_view text);

}  // namespace palpate
