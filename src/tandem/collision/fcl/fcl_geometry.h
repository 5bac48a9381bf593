#pragma once
/// Private to this folder: geometry as FCL sees it, and its distances.

#include <fcl/geometry/collision_geometry.h>

#include <array>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tandem/collision/checker.h"
#include "tandem/core/result.h"

namespace tandem::collision {

/// A geometry fixed on a link, with frame G, swept by a sphere: a convex solid or a mesh.
struct FclPiece {
  std::shared_ptr<const fcl::CollisionGeometryd> solid;    ///< Convex; null for a mesh.
  std::shared_ptr<const fcl::CollisionGeometryd> surface;  ///< Its triangles.
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
  double radius = 0;
  /// Some point of every part of it that hangs together.
  std::vector<Eigen::Vector3d> points_G{Eigen::Vector3d::Zero()};
  bool is_hollow = false;  ///< A surface without an inside, whatever it seems to enclose.
  // Of a solid: what it is the hull of, and where its supporting planes may lie when it overlaps
  // another. A cylinder is given by its size, along z.
  std::vector<Eigen::Vector3d> vertices_G, normals_G, edges_G;
  double cylinder_radius = 0, cylinder_half_length = 0;

  bool is_mesh() const { return !solid; }
  /// The point of the solid that is furthest along n.
  Eigen::Vector3d support(const Eigen::Vector3d& n_G) const;
};

/// Meshes by file and scale, so that each is read once.
using FclMeshes = std::map<std::pair<std::string, std::array<double, 3>>, FclPiece>;

/// A shape's core as a solid, its radius kept apart.
FclPiece make_piece(const geometry::Shape& shape_L);

/// A triangle mesh, fixed on a link, swept by `padding` more [m].
FclPiece make_piece(const geometry::PlacedSurface& mesh_L, double padding);

/// A piece of a URDF link.
/// @param link  its name, for messages.
/// @return kNotFound for a mesh whose package was not found; kIo or kInvalidInput for one that
/// cannot be read.
Result<FclPiece> make_piece(const robot::Geometry& geometry, const std::string& link,
                            FclMeshes& meshes);

/// Box around a piece or body in W.
struct FclBox {
  Eigen::Vector3d center, half;
};

/// Signed distance of two boxes: no more than that of what they contain [m].
double distance(const FclBox& a, const FclBox& b);

FclBox box_around(const FclPiece& piece, const Eigen::Isometry3d& X_WG);
FclBox box_around(const FclBox& box_L, const Eigen::Isometry3d& X_WL);

/// Distance, normal and points of two pieces without their radii.
struct CoreDistance {
  double distance = -std::numeric_limits<double>::infinity();  ///< [m] signed
  Eigen::Vector3d nhat_BA_W = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d p_Wa = Eigen::Vector3d::Zero(), p_Wb = Eigen::Vector3d::Zero();
};

/// Of two solids: FCL's answer, believed only with planes that separate them. A distance of at
/// least `limit` may be any such.
CoreDistance solid_distance(const FclPiece& a, const Eigen::Isometry3d& X_WA, const FclPiece& b,
                            const Eigen::Isometry3d& X_WB, double limit);
/// Of two surfaces, one of them at least a mesh; what lies within the other is deep.
CoreDistance surface_distance(const FclPiece& a, const Eigen::Isometry3d& X_WA, const FclPiece& b,
                              const Eigen::Isometry3d& X_WB, double limit);

}  // namespace tandem::collision
