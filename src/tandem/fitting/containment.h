#pragma once
/// The proof that volumes contain a mesh.

#include <Eigen/Core>
#include <optional>
#include <span>

#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/shape.h"

namespace tandem::fitting {

/// A part of a triangle that could not be shown to lie inside.
struct Gap {
  int triangle;          ///< Index into the mesh's triangles.
  Eigen::Vector3d p_LG;  ///< [m] the part's corner that sticks out furthest.
  double distance;       ///< [m] of that corner to the nearest volume; below `kFinest` it may be
                         ///< negative: every corner is inside, but in different volumes.
};

inline constexpr double kFinest = 1e-4;    ///< [m] longest edge of a part that is not split again.
inline constexpr double kRounding = 1e-9;  ///< [m] by which corners must lie inside.

/// Proves that every point of every triangle lies in the union of convex `volumes`, or names a part
/// for which that fails. A part whose three corners lie in one volume lies in it, for volumes are
/// convex; any other part is halved until it does or its longest edge is below `kFinest`. What is
/// accepted is contained, whatever the mesh; what is contained with 0.1 mm to spare is accepted.
/// Only the surface is looked at: an inner part of a solid may stay uncovered.
/// Cost: corners times volumes; parts are split only where volumes meet.
std::optional<Gap> prove_containment(const geometry::TriangleMesh& mesh_L,
                                     std::span<const geometry::Shape> volumes_L);

}  // namespace tandem::fitting
