#pragma once

#include "viewer/export/grid.hpp"

// VTK's XML formats. Numbers are written in base64 ("binary"), not compressed, so that each file is
// well-formed XML. Raw bytes after the text would be a quarter smaller, but VTK 9.1 cannot read
// them with Expat 2.5.0-1+deb12u5.

namespace palpate {

/// Returns the bytes of a .vtu file. The unit of each array is an attribute of its DataArray, and
/// the grid's texts are attributes of VTKFile. Programs that read the file ignore both.
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
