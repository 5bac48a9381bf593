#include "tandem/collision/fcl/fcl_geometry.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "tandem/geometry/mesh_file.h"

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;
using geometry::TriangleMesh;

std::shared_ptr<const fcl::CollisionGeometryd> make_surface(const TriangleMesh& mesh) {
  auto surface = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  std::vector<fcl::Triangle> triangles;
  for (const auto& [i, j, k] : mesh.triangles) {
    triangles.emplace_back(static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                           static_cast<std::size_t>(k));
  }
  surface->beginModel();
  surface->addSubModel(mesh.vertices, triangles);
  surface->endModel();
  surface->computeLocalAABB();
  return surface;
}

/// A vertex of every part whose triangles share vertices.
std::vector<Vector3d> part_points(const TriangleMesh& mesh) {
  std::vector<int> part(mesh.vertices.size());
  std::iota(part.begin(), part.end(), 0);
  const auto of = [&part](int v) -> int& { return part[static_cast<std::size_t>(v)]; };
  const auto root = [&of](int v) {
    while (of(v) != v) v = of(v) = of(of(v));
    return v;
  };
  std::set<int> parts;
  for (const auto& [p, q, r] : mesh.triangles) of(root(p)) = of(root(q)) = root(r);
  for (const auto& triangle : mesh.triangles) parts.insert(root(triangle[0]));
  std::vector<Vector3d> points;
  for (const int v : parts) points.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  return points;
}

void add_direction(std::vector<Vector3d>& directions, const Vector3d& v) {
  if (v.norm() > 0) directions.push_back(v.normalized());
}

/// {c + s0 u0 + s1 u1 + s2 u2, |si| <= 1}; u may be 0 from some column on.
FclPiece orthotope_piece(const Vector3d& c, const Matrix3d& u) {
  const Vector3d x = u.col(0), y = u.col(1), z = u.col(2);
  TriangleMesh mesh;
  if (y.norm() == 0) {  // A segment or point: FCL wants triangles.
    mesh = {{c - x, c + x, c + x}, {{0, 1, 2}}};
  } else if (z.norm() == 0) {
    mesh = {{c - x - y, c + x - y, c + x + y, c - x + y}, {{0, 1, 2}, {0, 2, 3}}};
  } else {
    for (int i = 0; i < 8; ++i) {
      mesh.vertices.push_back(c + (i & 1 ? x : -x) + (i & 2 ? y : -y) + (i & 4 ? z : -z));
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  }
  FclPiece piece;
  piece.vertices_G = mesh.vertices;
  piece.surface = make_surface(mesh);
  for (const Vector3d& v : {x, y, z}) add_direction(piece.edges_G, v);
  for (const Vector3d& v : {Vector3d(x.cross(y)), Vector3d(y.cross(z)), Vector3d(z.cross(x))}) {
    add_direction(piece.normals_G, v);
  }
  return piece;
}

FclPiece triangle_piece(const Vector3d& c, const Vector3d& u, const Vector3d& v) {
  FclPiece piece;
  piece.vertices_G = {c, c + u, c + v};
  piece.surface = make_surface({piece.vertices_G, {{0, 1, 2}}});
  for (const Vector3d& edge : {u, v, Vector3d(v - u)}) {
    add_direction(piece.edges_G, edge);
    add_direction(piece.normals_G, edge.cross(u.cross(v)));  // Sideways, out of the edge.
  }
  add_direction(piece.normals_G, u.cross(v));
  return piece;
}

FclPiece convex_piece(const Shape& shape_L) {
  const geometry::ConvexHull& hull = shape_L.hull();
  const Matrix3d& u = shape_L.extents();
  FclPiece piece;
  piece.vertices_G = shape_L.hull_vertices();
  piece.surface = make_surface({piece.vertices_G, hull.triangles});
  for (const Vector3d& n : hull.normals) add_direction(piece.normals_G, u * n);
  for (const auto& [i, j] : hull.edges) {
    const Vector3d edge =
        hull.vertices[static_cast<std::size_t>(j)] - hull.vertices[static_cast<std::size_t>(i)];
    add_direction(piece.edges_G, u * edge);
    // Sideways, out of the edge.
    if (hull.flat) add_direction(piece.normals_G, u * edge.cross(hull.normals.front()));
  }
  return piece;
}

void finish_polytope(FclPiece& piece) {
  // FCL's solver asks a polytope for its vertices only; any face will do.
  const auto vertices = std::make_shared<std::vector<Vector3d>>(piece.vertices_G);
  const auto faces = std::make_shared<std::vector<int>>(std::vector{3, 0, 1, 2});
  piece.solid = std::make_shared<fcl::Convexd>(vertices, 1, faces, false);
  piece.points_G = {piece.vertices_G.front()};
}

/// Along z. Its surface is a prism around it.
FclPiece cylinder_piece(double radius, double length) {
  constexpr int kSides = 128;
  FclPiece piece;
  piece.solid = std::make_shared<fcl::Cylinderd>(radius, length);
  piece.cylinder_radius = radius;
  piece.cylinder_half_length = 0.5 * length;
  piece.normals_G = piece.edges_G = {Vector3d::UnitZ()};
  TriangleMesh prism;
  const double outer = radius / std::cos(std::numbers::pi / kSides);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const double z : {-0.5 * length, 0.5 * length}) {
      prism.vertices.emplace_back(outer * std::cos(angle), outer * std::sin(angle), z);
    }
    const int low = 2 * i, next = 2 * ((i + 1) % kSides);
    prism.triangles.push_back({low, next, next + 1});
    prism.triangles.push_back({low, next + 1, low + 1});
    if (i < 2) continue;
    prism.triangles.push_back({0, low, low - 2});
    prism.triangles.push_back({1, low - 1, low + 1});
  }
  piece.surface = make_surface(prism);
  return piece;
}

Result<FclPiece> mesh_piece(const robot::MeshGeometry& mesh, const std::string& link,
                            FclMeshes& meshes) {
  if (mesh.path.empty()) {
    return fail(ErrorCode::kNotFound, "link '" + link + "': the package of its mesh '" + mesh.uri +
                                          "' was not found; name the folder that holds it with "
                                          "--package-path");
  }
  const std::pair key{mesh.path, std::array{mesh.scale.x(), mesh.scale.y(), mesh.scale.z()}};
  if (const auto known = meshes.find(key); known != meshes.end()) return known->second;
  const Result<TriangleMesh> read = geometry::read_mesh(mesh.path, mesh.scale);
  if (!read) return fail(read.error().code, "link '" + link + "': " + read.error().message);
  FclPiece piece;
  piece.surface = make_surface(*read);
  piece.points_G = {read->vertices[static_cast<std::size_t>(read->triangles.front()[0])]};
  return meshes.emplace(key, piece).first->second;
}

/// What URDF calls by the same names.
struct ToPiece {
  const std::string& link;
  FclMeshes& meshes;

  Result<FclPiece> operator()(const robot::BoxGeometry& box) const {
    FclPiece piece = orthotope_piece(Vector3d::Zero(), (0.5 * box.size).asDiagonal());
    finish_polytope(piece);
    return piece;
  }
  Result<FclPiece> operator()(const robot::SphereGeometry& sphere) const {
    FclPiece piece = orthotope_piece(Vector3d::Zero(), Matrix3d::Zero());
    finish_polytope(piece);
    piece.radius = sphere.radius;
    return piece;
  }
  Result<FclPiece> operator()(const robot::CylinderGeometry& cylinder) const {
    return cylinder_piece(cylinder.radius, cylinder.length);
  }
  Result<FclPiece> operator()(const robot::MeshGeometry& mesh) const {
    return mesh_piece(mesh, link, meshes);
  }
};

}  // namespace

Vector3d FclPiece::support(const Vector3d& n_G) const {
  if (vertices_G.empty()) {
    const double across = n_G.head<2>().norm();
    const double scale = across > 0 ? cylinder_radius / across : 0.0;
    return {scale * n_G.x(), scale * n_G.y(),
            n_G.z() > 0 ? cylinder_half_length : -cylinder_half_length};
  }
  const Vector3d* furthest = &vertices_G.front();
  for (const Vector3d& v : vertices_G) {
    if (n_G.dot(v) > n_G.dot(*furthest)) furthest = &v;
  }
  return *furthest;
}

FclPiece make_piece(const Shape& shape_L) {
  const Matrix3d& u = shape_L.extents();
  FclPiece piece;
  if (shape_L.type() == CoreType::kCylinder) {
    piece = cylinder_piece(shape_L.core_radius(), 2 * u.col(0).norm());
    piece.X_LG.linear() =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), u.col(0)).toRotationMatrix();
    piece.X_LG.translation() = shape_L.origin();
  } else {
    piece = shape_L.type() == CoreType::kConvex ? convex_piece(shape_L)
            : shape_L.type() == CoreType::kTriangle
                ? triangle_piece(shape_L.origin(), u.col(0), u.col(1))
                : orthotope_piece(shape_L.origin(), u);
    finish_polytope(piece);
  }
  piece.radius = shape_L.radius();
  return piece;
}

FclPiece make_piece(const geometry::PlacedSurface& mesh_L, double padding) {
  const geometry::Surface& surface = *mesh_L.surface;
  const TriangleMesh mesh{surface.vertices(), surface.triangles()};
  FclPiece piece;
  piece.surface = make_surface(mesh);
  piece.X_LG = mesh_L.X_FS;
  piece.radius = surface.radius() + padding;
  piece.points_G = part_points(mesh);
  piece.is_hollow = !surface.is_closed();
  return piece;
}

Result<FclPiece> make_piece(const robot::Geometry& geometry, const std::string& link,
                            FclMeshes& meshes) {
  Result<FclPiece> piece = std::visit(ToPiece{link, meshes}, geometry.shape);
  if (piece) piece->X_LG = geometry.X_LG;
  return piece;
}

double distance(const FclBox& a, const FclBox& b) {
  const Vector3d gap = (a.center - b.center).cwiseAbs() - a.half - b.half;
  const double widest = gap.maxCoeff();
  return widest > 0 ? gap.cwiseMax(0.0).norm() : widest;
}

FclBox box_around(const FclPiece& piece, const Isometry3d& X_WG) {
  const fcl::AABBd& box = piece.surface->aabb_local;
  return {
      X_WG * Vector3d(0.5 * (box.min_ + box.max_)),
      X_WG.linear().cwiseAbs() * (0.5 * (box.max_ - box.min_)) + Vector3d::Constant(piece.radius)};
}

FclBox box_around(const FclBox& box_L, const Isometry3d& X_WL) {
  return {X_WL * box_L.center, X_WL.linear().cwiseAbs() * box_L.half};
}

}  // namespace tandem::collision
