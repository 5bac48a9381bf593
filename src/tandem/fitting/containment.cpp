#include "tandem/fitting/containment.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tandem/core/contract.h"
#include "tandem/geometry/distance.h"

namespace tandem::fitting {

using Eigen::Vector3d;

namespace {

/// A corner of a part with its distance to every volume.
struct Corner {
  Vector3d p;
  std::vector<double> distances;

  Corner(const Vector3d& point, std::span<const geometry::Shape> volumes) : p(point) {
    for (const auto& volume : volumes) {
      distances.push_back(geometry::distance_to_point(volume, point));
    }
  }
  double least() const { return *std::min_element(distances.begin(), distances.end()); }
};

bool lies_in_one(const Corner& a, const Corner& b, const Corner& c) {
  for (std::size_t i = 0; i < a.distances.size(); ++i) {
    if (std::max({a.distances[i], b.distances[i], c.distances[i]}) <= -kRounding) return true;
  }
  return false;
}

/// The part of triangle a, b, c that is not covered.
std::optional<Gap> uncovered(const Corner& a, const Corner& b, const Corner& c,
                             std::span<const geometry::Shape> volumes) {
  if (lies_in_one(a, b, c)) return std::nullopt;
  const double ab = (b.p - a.p).norm(), bc = (c.p - b.p).norm(), ca = (a.p - c.p).norm();
  const double longest = std::max({ab, bc, ca});
  const Corner* out = &a;
  for (const Corner* corner : {&b, &c}) {
    if (corner->least() > out->least()) out = corner;
  }
  // A corner outside settles it: no part that has it can be covered.
  if (longest < kFinest || out->least() > -kRounding) return Gap{-1, out->p, out->least()};
  const auto halves = [&](const Corner& from, const Corner& to, const Corner& tip) {
    const Corner middle((from.p + to.p) / 2, volumes);
    const auto gap = uncovered(from, middle, tip, volumes);
    return gap ? gap : uncovered(middle, to, tip, volumes);
  };
  if (longest == ab) return halves(a, b, c);
  return longest == bc ? halves(b, c, a) : halves(c, a, b);
}

}  // namespace

std::optional<Gap> prove_containment(const geometry::TriangleMesh& mesh_L,
                                     std::span<const geometry::Shape> volumes_L) {
  expects(!volumes_L.empty(), "prove_containment: there is at least one volume");
  std::vector<Corner> corners;
  corners.reserve(mesh_L.vertices.size());
  for (const Vector3d& p : mesh_L.vertices) corners.emplace_back(p, volumes_L);
  for (std::size_t t = 0; t < mesh_L.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) -> const Corner& {
      return corners[static_cast<std::size_t>(mesh_L.triangles[t][k])];
    };
    auto gap = uncovered(corner(0), corner(1), corner(2), volumes_L);
    if (!gap) continue;
    gap->triangle = static_cast<int>(t);
    return gap;
  }
  return std::nullopt;
}

}  // namespace tandem::fitting
