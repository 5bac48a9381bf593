#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace tandem::geometry {

namespace {

Vector3r support(const Shape& shape, const Vector3r& n) {
  const Eigen::Matrix<Real, 3, 3> u = shape.extents().cast<Real>();
  Vector3r p = shape.origin().cast<Real>();
  if (shape.type() == CoreType::kTriangle) {
    const Vector3r corners[] = {Vector3r::Zero(), u.col(0), u.col(1)};
    return p + *std::max_element(corners, corners + 3, [&](const Vector3r& v, const Vector3r& w) {
             return v.dot(n) < w.dot(n);
           });
  }
  if (shape.type() == CoreType::kConvex) {
    const auto& vertices = shape.hull().vertices;
    const Vector3r n_H = u.transpose() * n;
    return p + u * std::ranges::max_element(vertices, {}, [&](const auto& v) {
                     return v.template cast<Real>().dot(n_H);
                   })->template cast<Real>();
  }
  for (int i = 0; i < shape.size_count(); ++i) p += (u.col(i).dot(n) < 0 ? -1 : 1) * u.col(i);
  if (shape.type() == CoreType::kCylinder) {
    const Vector3r along = u.col(0).normalized();
    Vector3r across = n - along.dot(n) * along;
    across -= along.dot(across) * along;
    if (across.norm() > 0) p += Real(shape.core_radius()) * across.normalized();
  }
  return p;
}

/// Weights, summing to 1 but of any sign, of the point nearest to the origin in the affine hull.
Eigen::Matrix<Real, Eigen::Dynamic, 1> affine_weights(const std::vector<Vector3r>& points) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::Matrix<Real, Eigen::Dynamic, 1> weights(n);
  if (n == 1) return weights.setOnes();
  Eigen::Matrix<Real, 3, Eigen::Dynamic> edges(3, n - 1);
  for (Eigen::Index i = 1; i < n; ++i)
    edges.col(i - 1) = points[static_cast<std::size_t>(i)] - points[0];
  weights.tail(n - 1) = edges.colPivHouseholderQr().solve(-points[0]);
  weights[0] = 1 - weights.tail(n - 1).sum();
  return weights;
}

}  // namespace

Bounds core_distance(const Shape& a, const Shape& b) {
  std::vector<Vector3r> corral{(a.origin() - b.origin()).cast<Real>()};
  std::vector<Real> weights{1};
  Vector3r v = corral[0];
  Real low = 0;
  for (int step = 0; step < 300; ++step) {
    if (v.norm() < 1e-12L) return {0, static_cast<double>(v.norm())};
    const Vector3r w = support(a, -v) - support(b, v);
    low = std::max(low, v.dot(w) / v.norm());
    if (v.norm() - low < 1e-14L) break;
    corral.push_back(w);
    weights.push_back(0);
    for (;;) {
      const auto target = affine_weights(corral);
      Real t = 1;
      for (std::size_t i = 0; i < corral.size(); ++i) {
        const Real goal = target[static_cast<Eigen::Index>(i)];
        if (goal < 0) t = std::min(t, weights[i] / (weights[i] - goal));
      }
      for (std::size_t i = 0; i < corral.size(); ++i) {
        weights[i] += t * (target[static_cast<Eigen::Index>(i)] - weights[i]);
      }
      if (t == 1) break;
      // At least one weight is now zero but for rounding.
      const auto least = std::min_element(weights.begin(), weights.end()) - weights.begin();
      corral.erase(corral.begin() + least);
      weights.erase(weights.begin() + least);
    }
    Vector3r next = Vector3r::Zero();
    for (std::size_t i = 0; i < corral.size(); ++i) next += weights[i] * corral[i];
    // Steps that gain nothing computable may still turn v to where the bounds meet.
    if (next.norm() > v.norm() * (1 + 1e-18L) || next == v) break;
    v = next;
  }
  return {static_cast<double>(low), static_cast<double>(v.norm())};
}

}  // namespace tandem::geometry
