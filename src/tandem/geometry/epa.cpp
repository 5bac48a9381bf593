#include "tandem/geometry/epa.h"

#include <algorithm>
#include <array>
#include <optional>
#include <queue>
#include <vector>

#include "tandem/geometry/polytope.h"

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

constexpr int kNone = -1;
/// [m] Facets whose plane is nearer to a new vertex than this are replaced: a facet between the two
/// might have no area.
constexpr double kCoplanar = 1e-13;

struct Facet {
  std::array<int, 3> vertices;    ///< Counter-clockwise from outside.
  std::array<int, 3> neighbours;  ///< Across the edge from vertex i to vertex i + 1.
  Vector3d nhat;
  double offset;  ///< Of its plane from the origin, along nhat.
  bool alive = true;
};

/// A convex polytope with triangular facets that grows by one vertex at a time.
class Polytope {
 public:
  /// The octahedron c +- x, +- y, +- z.
  Polytope(const Vector3d& c, const Vector3d& x, const Vector3d& y, const Vector3d& z) {
    vertices_ = {c + x, c - x, c + y, c - y, c + z, c - z};
    for (int i = 0; i < 8; ++i) {
      const int vx = i & 1 ? 1 : 0, vy = i & 2 ? 3 : 2, vz = i & 4 ? 5 : 4;
      const bool even = (vx + vy + vz) % 2 == 0;
      // Neighbours differ in the sign of the axis whose vertex the edge leaves out.
      if (even) {
        add({vx, vy, vz}, {i ^ 4, i ^ 1, i ^ 2});
      } else {
        add({vx, vz, vy}, {i ^ 2, i ^ 1, i ^ 4});
      }
    }
    if (facets_.size() != 8) queue_ = {};
  }

  /// The facet whose plane is nearest to the origin, counting outside as negative; none if the
  /// octahedron had no volume.
  std::optional<Facet> nearest() {
    while (!queue_.empty() && !facet(queue_.top().second).alive) queue_.pop();
    if (queue_.empty()) return std::nullopt;
    return facet(queue_.top().second);
  }

  /// Makes the surroundings of the facet that `nearest` gave reach out to `w` beyond it.
  /// @return false if rounding left no valid polytope: then it must not be used again.
  bool expand_nearest(const Vector3d& w);

 private:
  bool add(const std::array<int, 3>& vertices, const std::array<int, 3>& neighbours) {
    const Vector3d& p = vertices_[static_cast<std::size_t>(vertices[0])];
    const Vector3d u = vertices_[static_cast<std::size_t>(vertices[1])] - p;
    const Vector3d v = vertices_[static_cast<std::size_t>(vertices[2])] - p;
    const Vector3d n = accurate_cross(u, v);
    const double length = n.norm();
    if (!(length > 0)) return false;
    facets_.push_back({vertices, neighbours, n / length, n.dot(p) / length});
    queue_.emplace(-facets_.back().offset, static_cast<int>(facets_.size()) - 1);
    return true;
  }
  Facet& facet(int i) { return facets_[static_cast<std::size_t>(i)]; }

  std::vector<Vector3d> vertices_;
  std::vector<Facet> facets_;
  std::priority_queue<std::pair<double, int>> queue_;
};

bool Polytope::expand_nearest(const Vector3d& w) {
  struct Rim {
    int from, to, outer, inner;  // Edge, the facet that stays, the facet that goes.
  };
  std::vector<int> gone{queue_.top().second};
  std::vector<Rim> rims;
  facet(gone[0]).alive = false;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    const Facet current = facet(gone[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      Facet& next = facet(current.neighbours[k]);
      if (!next.alive) continue;
      if (next.nhat.dot(w) > next.offset - kCoplanar) {
        next.alive = false;
        gone.push_back(current.neighbours[k]);
      } else {
        rims.push_back(
            {current.vertices[k], current.vertices[(k + 1) % 3], current.neighbours[k], gone[i]});
      }
    }
  }
  // A facet seen late may have been put on the rim before.
  std::erase_if(rims, [&](const Rim& rim) { return !facet(rim.outer).alive; });

  const int apex = static_cast<int>(vertices_.size());
  vertices_.push_back(w);
  const int first = static_cast<int>(facets_.size()), count = static_cast<int>(rims.size());
  std::vector<int> starting_at(vertices_.size(), kNone);
  for (int i = 0; i < count; ++i) {
    int& slot = starting_at[static_cast<std::size_t>(rims[static_cast<std::size_t>(i)].from)];
    if (slot != kNone) return false;
    slot = first + i;
  }
  for (const Rim& rim : rims) {
    if (starting_at[static_cast<std::size_t>(rim.to)] == kNone) return false;
    if (!add({rim.from, rim.to, apex},
             {rim.outer, starting_at[static_cast<std::size_t>(rim.to)], kNone})) {
      return false;
    }
  }
  for (int i = 0; i < count; ++i) {
    facet(facet(first + i).neighbours[1]).neighbours[2] = first + i;
    const Rim& rim = rims[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < 3; ++k) {
      Facet& outer = facet(rim.outer);
      if (outer.neighbours[k] == rim.inner && outer.vertices[k] == rim.to) {
        outer.neighbours[k] = first + i;
      }
    }
  }
  return true;
}

}  // namespace

namespace {

/// Half axes of an octahedron in a core about its origin; zero if the core has no volume.
Eigen::Matrix3d octahedron_in(const Shape& shape) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
  if (shape.type() == CoreType::kBox) axes = shape.extents();
  if (shape.type() == CoreType::kConvex) axes = shape.extents() * shape.hull().inner;
  if (shape.type() == CoreType::kCylinder) {
    const Vector3d z = shape.extents().col(0);
    axes.col(0) = z;
    axes.col(1) = shape.core_radius() * z.unitOrthogonal();
    axes.col(2) = z.normalized().cross(axes.col(1));
  }
  return axes;
}

}  // namespace

Separation expand_polytope(const Shape& a, const Shape& b, const Separation& guess) {
  constexpr int kSteps = 1000;
  const bool curved = a.type() == CoreType::kCylinder || b.type() == CoreType::kCylinder;
  const double tolerance = curved ? 1e-8 : 1e-12;  // [m] Facets, unlike curves, are reached.
  const Eigen::Matrix3d in_a = octahedron_in(a), in_b = octahedron_in(b);
  const Eigen::Matrix3d& x =
      std::abs(in_a.determinant()) > std::abs(in_b.determinant()) ? in_a : in_b;
  Polytope polytope(b.origin() - a.origin(), x.col(0), x.col(1), x.col(2));
  Separation best = guess;
  for (int step = 0; step < kSteps; ++step) {
    const std::optional<Facet> nearest = polytope.nearest();
    if (!nearest || -best.gap <= nearest->offset + tolerance) break;
    const Vector3d w = b.support(nearest->nhat) - a.support(-nearest->nhat);
    const double reach = w.dot(nearest->nhat);
    if (-reach > best.gap) best = {nearest->nhat, -reach};
    if (reach <= nearest->offset + tolerance || !polytope.expand_nearest(w)) break;
  }
  return best;
}

}  // namespace tandem::geometry::detail
