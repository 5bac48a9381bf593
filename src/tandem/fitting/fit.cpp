#include "tandem/fitting/fit.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/fitting/containment.h"
#include "tandem/fitting/search.h"

namespace tandem::fitting {

using geometry::Shape;
using geometry::TriangleMesh;

namespace {

Result<void> check_corners(const TriangleMesh& mesh) {
  constexpr double kLargest = 1e3;  // [m]
  for (const Eigen::Vector3d& p : mesh.vertices) {
    if (!p.allFinite()) {
      return fail(ErrorCode::kInvalidInput, "the mesh has a corner that is not finite; repair it");
    }
    const double reach = p.lpNorm<Eigen::Infinity>();
    if (reach < kLargest) continue;
    return fail(ErrorCode::kInvalidInput,
                "the mesh has a corner " + std::to_string(reach) +
                    " m from its link's origin, 1000 m is the most; one in millimetres needs "
                    "scale=\"0.001 0.001 0.001\" in the URDF");
  }
  const auto is_known = [&](int i) {
    return i >= 0 && static_cast<std::size_t>(i) < mesh.vertices.size();
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::ranges::all_of(mesh.triangles[t], is_known)) continue;
    return fail(ErrorCode::kInvalidInput,
                "triangle " + std::to_string(t) + " of the mesh has a corner that does not exist");
  }
  return {};
}

Result<void> check_mesh(const TriangleMesh& mesh) {
  constexpr double kLeastArea = 1e-10;  // [m^2]
  if (auto good = check_corners(mesh); !good) return good;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto p = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
    area += (p(b) - p(a)).cross(p(c) - p(a)).norm() / 2;
  }
  if (area > kLeastArea) return {};
  return fail(ErrorCode::kInvalidInput,
              "the mesh has no area; repair it, or its scale in the URDF");
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

Result<MeshFit> fit_mesh(const TriangleMesh& mesh_L, const FitOptions& options,
                         const StopCondition& stop) {
  expects(options.count >= 1, "fit_mesh: at least one volume");
  expects(options.starts >= 1, "fit_mesh: at least one start");
  expects(options.padding >= 0 && std::isfinite(options.padding), "fit_mesh: padding >= 0");
  expects(options.kinds.any(), "fit_mesh: at least one kind of volume");
  const auto begin = Clock::now();
  if (auto good = check_mesh(mesh_L); !good) return std::unexpected(good.error());
  const Solid solid(mesh_L);
  Rng rng(options.seed);
  const Candidate found =
      search(mesh_L, solid, {options.count, options.starts, options.kinds}, rng, stop);
  if (stop.cancelled()) return std::unexpected(stop.error("fitting volumes"));
  MeshFit fit;
  fit.cut_short = stop.timed_out();
  for (const Core& core : found.cores) fit.volumes_L.push_back(core.shape());
  // Growth and proof are two pieces of code; should they ever disagree, it must not go unnoticed.
  expects(!prove_containment(mesh_L, fit.volumes_L), "fit_mesh: the volumes contain the mesh");
  const Excess excess = measure(solid, Bounds::of(mesh_L), fit.volumes_L, rng);
  fit.triangles = static_cast<int>(mesh_L.triangles.size());
  fit.is_closed = solid.is_closed();
  fit.area = solid.area();
  fit.solid = excess.solid;
  fit.excess = excess.outside;
  fit.protrusion = excess.protrusion;
  for (Shape& shape : fit.volumes_L) shape = shape.padded(options.padding);
  fit.seconds = seconds_since(begin);
  return fit;
}

Result<LinkFit> fit_link(const robot::Link& link, const FitOptions& options,
                         const StopCondition& stop) {
  if (link.collision.empty()) {
    return fail(ErrorCode::kInvalidInput,
                "link '" + link.name + "' has no collision geometry to fit volumes to");
  }
  const auto mesh = link_mesh(link);
  if (!mesh) return std::unexpected(mesh.error());
  LinkFit fit;
  if (!mesh->mesh_L.triangles.empty()) {
    auto fitted = fit_mesh(mesh->mesh_L, options, stop);
    if (!fitted) {
      return fail(fitted.error().code, "link '" + link.name + "': " + fitted.error().message);
    }
    static_cast<MeshFit&>(fit) = *std::move(fitted);
  }
  for (const Shape& sphere : mesh->spheres_L) {
    fit.volumes_L.push_back(sphere.padded(options.padding));
  }
  fit.link = link.name;
  fit.source = mesh->source;
  return fit;
}

}  // namespace tandem::fitting
