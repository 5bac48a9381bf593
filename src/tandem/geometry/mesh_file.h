#pragma once
/// Triangle meshes and point clouds from files.

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::geometry {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;      ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< Indices into `vertices`, at least one.
};

/// Reads STL, OBJ, COLLADA, PLY; vertices are multiplied by `scale`. Equal vertices are joined.
/// Up directions that a file states are ignored, as by every reader of URDF.
/// Polygons become triangles; of COLLADA, what the scene shows, in metres, without skeletons
/// (kUnsupported).
/// @return kIo or kInvalidInput naming the file if it cannot be read, holds no triangles, has a
/// vertex that is not finite, or more than it may have (10 million triangles, 1 GB).
Result<TriangleMesh> read_mesh(const std::filesystem::path& file,
                               const Eigen::Vector3d& scale = Eigen::Vector3d::Ones());

/// Reads the points of a PLY (ascii, binary), PCD (ascii, binary) or XYZ file; points that are not
/// finite, as depth cameras deliver them, are left out.
/// @return kIo or kInvalidInput naming the file, and line or byte where it can, if it cannot be
/// read, has no finite point, or more than it may have (10 million points, 1 GB).
Result<std::vector<Eigen::Vector3d>> read_cloud(const std::filesystem::path& file);

}  // namespace tandem::geometry
