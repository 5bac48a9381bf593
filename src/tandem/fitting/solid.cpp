#include "tandem/fitting/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "tandem/geometry/distance.h"

namespace tandem::fitting {

using Eigen::Vector3d;
using geometry::Shape;
using geometry::TriangleMesh;

namespace {

/// Solid angle of a triangle seen from the origin [sr], signed. Ref: van Oosterom, Strackee, 1983.
double solid_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Whether every edge is used as often one way as the other.
bool closed(const TriangleMesh& mesh) {
  // Files like STL repeat corners; what counts is where they are.
  const auto less = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::map<Vector3d, int, decltype(less)> names(less);
  std::vector<int> name;
  for (const Vector3d& p : mesh.vertices) {
    name.push_back(names.try_emplace(p, static_cast<int>(names.size())).first->second);
  }
  std::map<std::pair<int, int>, int> balance;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = name[static_cast<std::size_t>(triangle[k])];
      const int b = name[static_cast<std::size_t>(triangle[(k + 1) % 3])];
      if (a != b) balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return std::all_of(balance.begin(), balance.end(), [](const auto& e) { return e.second == 0; });
}

double point_triangle_squared(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                              const Vector3d& c) {
  const auto to_segment = [&](const Vector3d& from, const Vector3d& to) {
    const Vector3d u = to - from;
    const double uu = u.squaredNorm();
    const double t = uu > 0 ? std::clamp(u.dot(p - from) / uu, 0.0, 1.0) : 0.0;
    return (p - from - t * u).squaredNorm();
  };
  const Vector3d n = (b - a).cross(c - a);
  const bool over = n.cross(b - a).dot(p - a) > 0 && n.cross(c - b).dot(p - b) > 0 &&
                    n.cross(a - c).dot(p - c) > 0;
  if (over) return std::pow(n.dot(p - a), 2) / n.squaredNorm();
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

bool covered(const Vector3d& p, std::span<const Shape> volumes, const Shape* but = nullptr) {
  return std::any_of(volumes.begin(), volumes.end(), [&](const Shape& volume) {
    return &volume != but && geometry::distance_to_point(volume, p) <= 0;
  });
}

}  // namespace

Bounds Bounds::of(const TriangleMesh& mesh) {
  Bounds bounds{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vector3d& p : mesh.vertices) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  return bounds;
}

Bounds Bounds::of(std::span<const Shape> volumes) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Bounds bounds{Vector3d::Constant(kFar), Vector3d::Constant(-kFar)};
  for (const Shape& volume : volumes) {
    for (const Vector3d& p : volume.hull_vertices()) {
      bounds.low = bounds.low.cwiseMin(p - Vector3d::Constant(volume.radius()));
      bounds.high = bounds.high.cwiseMax(p + Vector3d::Constant(volume.radius()));
    }
  }
  return bounds;
}

Solid::Solid(const TriangleMesh& mesh) : closed_(closed(mesh)) {
  for (const auto& triangle : mesh.triangles) {
    const auto p = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    const Vector3d center = (p(0) + p(1) + p(2)) / 3;
    double radius = 0;
    for (std::size_t k = 0; k < 3; ++k) radius = std::max(radius, (p(k) - center).norm());
    const Vector3d n = (p(1) - p(0)).cross(p(2) - p(0)) / 2;
    area_ += n.norm();
    facets_.push_back({p(0), p(1), p(2), center, n, radius});
  }
}

bool Solid::contains(const Vector3d& p) const {
  constexpr double kFar = 5;  // Radii away, from where a triangle is seen as its centre to 1 %.
  double sum = 0;
  for (const Facet& f : facets_) {
    const Vector3d r = f.center - p;
    const double squared = r.squaredNorm();
    sum += squared > kFar * kFar * f.radius * f.radius ? r.dot(f.n) / (squared * std::sqrt(squared))
                                                       : solid_angle(f.a - p, f.b - p, f.c - p);
  }
  return std::abs(sum) > 2 * std::numbers::pi;
}

double Solid::distance(const Vector3d& p) const {
  double least = std::numeric_limits<double>::infinity(), squared = least;
  for (const Facet& f : facets_) {
    const double far = least + f.radius;
    if ((p - f.center).squaredNorm() > far * far) continue;
    squared = std::min(squared, point_triangle_squared(p, f.a, f.b, f.c));
    least = std::sqrt(squared);
  }
  return least;
}

Vector3d spread_point(std::size_t index) {
  constexpr double kPlastic = 1.22074408460575947536;  // Root of x^4 = x + 1.
  Vector3d p;
  double step = 1;
  for (double& x : p) {
    step /= kPlastic;
    const double value = 0.5 + step * static_cast<double>(index);
    x = value - std::floor(value);
  }
  return p;
}

Excess measure(const Solid& solid, const Bounds& bounds, std::span<const Shape> volumes, Rng& rng) {
  constexpr std::size_t kSamples = 20000, kSurfaceSamples = 600;
  const Bounds around = Bounds::of(volumes);
  const Vector3d low = around.low.cwiseMin(bounds.low), high = around.high.cwiseMax(bounds.high);
  const double share = (high - low).prod() / static_cast<double>(kSamples);
  Excess excess;
  for (std::size_t i = 1; i <= kSamples; ++i) {
    const Vector3d p = low + (high - low).cwiseProduct(spread_point(i));
    const bool in = ((p - bounds.low).array() >= 0).all() &&
                    ((bounds.high - p).array() >= 0).all() && solid.contains(p);
    if (in) {
      excess.solid += share;
    } else if (covered(p, volumes)) {
      excess.outside += share;
    }
  }
  for (const Shape& volume : volumes) {
    const Vector3d center = volume.bounding_center();
    for (std::size_t i = 0; i < kSurfaceSamples; ++i) {
      // From a random point of a ball around, straight to the nearest point of the surface.
      Vector3d n;
      do {
        for (double& x : n) x = rng.uniform(-1, 1);
      } while (n.squaredNorm() > 1);
      const Vector3d far = center + 2 * volume.bounding_radius() * n;
      const auto nearest = geometry::clearance(*Shape::sphere(far, 1e-6), volume);
      if (nearest.distance <= 0) continue;
      const Vector3d& p = nearest.p_WCb;
      if (covered(p, volumes, &volume) || solid.contains(p)) continue;
      excess.protrusion = std::max(excess.protrusion, solid.distance(p));
    }
  }
  return excess;
}

}  // namespace tandem::fitting
