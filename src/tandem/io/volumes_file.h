#pragma once
/// Volumes files, written. They are read by `load_volumes`; the schema is docs/workcell.md.

#include <string>
#include <vector>

#include "tandem/geometry/shape.h"

namespace tandem::io {

struct VolumesEntry {
  std::string link;
  std::string comment;  ///< One line about it; may be empty.
  std::vector<geometry::Shape> shapes_L;
};

/// The text of a volumes file. Numbers have 9 decimals, so that no point of a volume smaller than
/// 1 m is further than 3e-9 m from where it was.
/// @param comment  what the file is, any number of lines.
std::string volumes_text(const std::string& comment, const std::vector<VolumesEntry>& entries);

}  // namespace tandem::io
