#pragma once
/// The collision geometry of a link as triangles.

#include <string>
#include <vector>

#include "tandem/core/result.h"
#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/shape.h"
#include "tandem/robot/model.h"

namespace tandem::fitting {

/// All collision elements of one link, in L.
struct LinkMesh {
  /// Meshes as they are; boxes as 12 triangles; cylinders as prisms around them (64 sides, 0.12 %
  /// wider). May be empty if there are only spheres.
  geometry::TriangleMesh mesh_L;
  std::vector<geometry::Shape> spheres_L;  ///< Spheres are volumes already.
  std::string source;                      ///< "link5.stl", "2 boxes, 1 sphere": for tables.
};

/// @return kNotFound, kIo or kInvalidInput naming the link and the mesh file that is absent or
/// cannot be used, and what to do about it.
Result<LinkMesh> link_mesh(const robot::Link& link);

}  // namespace tandem::fitting
