#include "tandem/fitting/link_mesh.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

namespace tandem::fitting {

using Eigen::Vector3d;
using geometry::TriangleMesh;

namespace {

void append(const TriangleMesh& mesh_G, const Eigen::Isometry3d& X_LG, TriangleMesh& mesh_L) {
  const int first = static_cast<int>(mesh_L.vertices.size());
  for (const Vector3d& p : mesh_G.vertices) mesh_L.vertices.push_back(X_LG * p);
  for (const auto& [a, b, c] : mesh_G.triangles) {
    mesh_L.triangles.push_back({first + a, first + b, first + c});
  }
}

TriangleMesh box_mesh(const Vector3d& size) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.push_back(size.cwiseProduct(Vector3d(corner & 1, corner >> 1 & 1, corner >> 2)) -
                            size / 2);
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A prism whose sides touch the cylinder, about z.
TriangleMesh cylinder_mesh(double radius, double length) {
  constexpr int kSides = 64;
  const double corner = radius / std::cos(std::numbers::pi / kSides);
  TriangleMesh mesh;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const double z : {-length / 2, length / 2}) {
      mesh.vertices.emplace_back(corner * std::cos(angle), corner * std::sin(angle), z);
    }
  }
  for (int i = 0; i < kSides; ++i) {
    const int low = 2 * i, next = 2 * ((i + 1) % kSides);
    mesh.triangles.insert(mesh.triangles.end(), {{low, next, next + 1}, {low, next + 1, low + 1}});
    if (i == 0 || i + 1 == kSides) continue;
    mesh.triangles.insert(mesh.triangles.end(), {{0, next, low}, {1, low + 1, next + 1}});
  }
  return mesh;
}

Error with_link(const robot::Link& link, Error error) {
  error.message = "link '" + link.name + "': " + error.message;
  return error;
}

Result<TriangleMesh> file_mesh(const robot::Link& link, const robot::MeshGeometry& mesh) {
  if (mesh.path.empty()) {
    return fail(ErrorCode::kNotFound,
                "link '" + link.name + "': the package of '" + mesh.uri +
                    "' is not found; name the folder that holds it (--package-path DIR), or leave "
                    "this link out (--link names those to fit)");
  }
  std::error_code ignored;  // Whatever the reason, the file cannot be read.
  if (!std::filesystem::exists(mesh.path, ignored)) {
    return fail(ErrorCode::kNotFound,
                "link '" + link.name + "': there is no mesh file '" + mesh.path + "' ('" +
                    mesh.uri +
                    "' in the URDF); put the robot's meshes there, or leave this link out (--link "
                    "names those to fit)");
  }
  auto read = geometry::read_mesh(mesh.path, mesh.scale);
  if (!read) return std::unexpected(with_link(link, std::move(read.error())));
  return read;
}

std::string words(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + (count > 1 ? std::to_string(count) + " x " : "") + name;
  }
  return text;
}

}  // namespace

Result<LinkMesh> link_mesh(const robot::Link& link) {
  LinkMesh result;
  std::map<std::string, int> counts;
  for (const robot::Geometry& g : link.collision) {
    if (const auto* sphere = std::get_if<robot::SphereGeometry>(&g.shape)) {
      auto shape = geometry::Shape::sphere(g.X_LG.translation(), sphere->radius);
      if (!shape) return std::unexpected(with_link(link, std::move(shape.error())));
      result.spheres_L.push_back(*shape);
      ++counts["sphere"];
    } else if (const auto* box = std::get_if<robot::BoxGeometry>(&g.shape)) {
      append(box_mesh(box->size), g.X_LG, result.mesh_L);
      ++counts["box"];
    } else if (const auto* cylinder = std::get_if<robot::CylinderGeometry>(&g.shape)) {
      append(cylinder_mesh(cylinder->radius, cylinder->length), g.X_LG, result.mesh_L);
      ++counts["cylinder"];
    } else {
      const auto& mesh = std::get<robot::MeshGeometry>(g.shape);
      const auto read = file_mesh(link, mesh);
      if (!read) return std::unexpected(read.error());
      append(*read, g.X_LG, result.mesh_L);
      ++counts[std::filesystem::path(mesh.path).filename().string()];
    }
  }
  result.source = words(counts);
  return result;
}

}  // namespace tandem::fitting
