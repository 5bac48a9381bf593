#pragma once
/// Private to the readers of this folder: Wavefront OBJ.

#include <filesystem>
#include <string_view>

#include "tandem/geometry/mesh_file.h"

namespace tandem::geometry::detail {

/// Reads vertices and faces; polygons become fans. Everything else, such as normals, textures,
/// lines and curves, has no effect, and no other file is opened.
/// @return kInvalidInput with file and line.
Result<TriangleMesh> parse_obj(std::string_view text, const std::filesystem::path& file);

}  // namespace tandem::geometry::detail
