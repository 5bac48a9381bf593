#pragma once
/// Private to the readers of this folder: COLLADA.

#include <filesystem>
#include <string>

#include "tandem/geometry/mesh_file.h"

namespace tandem::geometry::detail {

/// Reads the triangles, polygons, strips and fans that the file's scene shows, in metres. Polygons
/// become fans, which cover them also where they are not convex. The up axis, materials and lines
/// have no effect. Files are not trusted: what they say of sizes, indices and instances is checked,
/// so the time is that of the bytes and of at most kMostItems triangles.
/// @return kInvalidInput with file and line: counts that disagree, indices out of range, nodes that
/// contain themselves; kUnsupported for skeletons, polygons with holes, lookat and skew.
Result<TriangleMesh> parse_collada(const std::string& bytes, const std::filesystem::path& file);

}  // namespace tandem::geometry::detail
