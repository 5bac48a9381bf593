#include "tandem/world/link_geometry.h"

#include <sstream>

#include "tandem/geometry/mesh_file.h"

namespace tandem::world {

namespace {

/// A URDF primitive as a shape.
struct ToShape {
  const Eigen::Isometry3d& X_LG;

  Result<geometry::Shape> operator()(const robot::SphereGeometry& sphere) const {
    return geometry::Shape::sphere(X_LG.translation(), sphere.radius);
  }
  Result<geometry::Shape> operator()(const robot::BoxGeometry& box) const {
    return geometry::Shape::box(X_LG, box.size);
  }
  Result<geometry::Shape> operator()(const robot::CylinderGeometry& cylinder) const {
    return geometry::Shape::cylinder(X_LG, cylinder.radius, cylinder.length);
  }
  Result<geometry::Shape> operator()(const robot::MeshGeometry&) const {
    return fail(ErrorCode::kUnsupported, "a mesh is no primitive");
  }
};

std::string key_of(const robot::MeshGeometry& mesh, RobotSpec::Meshes meshes) {
  std::ostringstream key;
  key.precision(17);
  key << mesh.scale.transpose() << (meshes == RobotSpec::Meshes::kConvex ? " convex " : " ")
      << mesh.path;
  return key.str();
}

std::unexpected<Error> unreadable(const robot::MeshGeometry& mesh, const Error& error) {
  return fail(error.code, "its collision mesh '" + mesh.uri + "': " + error.message +
                              "; mend the mesh, or give the link an entry in the robot's "
                              "`volumes:` file");
}

}  // namespace

Result<LinkGeometry> LinkGeometryReader::of_urdf(const robot::Link& link,
                                                 RobotSpec::Meshes meshes) {
  LinkGeometry geometry;
  for (const robot::Geometry& piece : link.collision) {
    if (const auto* mesh = std::get_if<robot::MeshGeometry>(&piece.shape)) {
      if (auto added = add_mesh(*mesh, piece.X_LG, meshes, geometry); !added) {
        return std::unexpected(added.error());
      }
      continue;
    }
    Result<geometry::Shape> shape = std::visit(ToShape{piece.X_LG}, piece.shape);
    if (!shape) return std::unexpected(shape.error());
    geometry.shapes.push_back(std::move(*shape));
  }
  return geometry;
}

Result<void> LinkGeometryReader::add_mesh(const robot::MeshGeometry& mesh,
                                          const Eigen::Isometry3d& X_LG, RobotSpec::Meshes meshes,
                                          LinkGeometry& out) {
  if (mesh.path.empty()) {
    const std::string searched = mesh.missing.empty() ? "" : " (" + mesh.missing + ")";
    return fail(ErrorCode::kNotFound,
                "its collision mesh '" + mesh.uri + "' was not found" + searched +
                    "; name the folder that holds it in `packages:` of the workcell or by "
                    "--package-path, or give the link an entry in the robot's `volumes:` file");
  }
  const auto [entry, is_new] = meshes_.try_emplace(key_of(mesh, meshes));
  if (is_new) {
    auto read = geometry::read_mesh(mesh.path, mesh.scale);
    if (!read) return unreadable(mesh, read.error());
    if (meshes == RobotSpec::Meshes::kConvex) {
      auto hull = geometry::Shape::convex(read->vertices);
      if (!hull) return unreadable(mesh, hull.error());
      entry->second.hull.push_back(std::move(*hull));
    } else {
      auto surface = geometry::Surface::mesh(std::move(read->vertices), std::move(read->triangles));
      if (!surface) return unreadable(mesh, surface.error());
      entry->second.surface = std::move(*surface);
    }
  }
  if (meshes == RobotSpec::Meshes::kConvex) {
    out.shapes.push_back(entry->second.hull.front().in(X_LG));
  } else {
    out.surfaces.push_back({entry->second.surface, X_LG});
  }
  return {};
}

}  // namespace tandem::world
