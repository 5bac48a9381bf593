#pragma once
/// PLY files, as meshes and as clouds.

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::geometry::detail {

/// What a PLY file holds: its element `vertex` with x, y, z, and its element `face`.
struct Ply {
  std::vector<Eigen::Vector3d> vertices;      ///< Some may not be finite.
  std::vector<std::array<int, 3>> triangles;  ///< Polygons as fans; indices into `vertices`.
};

/// @param file  its name, for messages.
/// @return kInvalidInput naming the file with line (ascii) or byte.
Result<Ply> parse_ply(std::string_view bytes, const std::filesystem::path& file);

}  // namespace tandem::geometry::detail
