#pragma once
/// Private to this folder: reads triangle meshes from files.

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::collision {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;              ///< [m]
  std::vector<std::array<std::size_t, 3>> triangles;  ///< Indices into `vertices`, at least one.
};

/// Reads STL, OBJ, COLLADA and whatever else assimp knows; vertices are multiplied by `scale`.
/// Up directions that a file states are ignored, as by every reader of URDF.
/// @return kIo naming the file if it cannot be read or holds no triangles.
Result<TriangleMesh> read_mesh(const std::string& file, const Eigen::Vector3d& scale);

}  // namespace tandem::collision
