#pragma once
/// The distance of two cores by an algorithm and in a precision apart from the library's.

#include <Eigen/Dense>
#include <vector>

#include "tandem/geometry/shape.h"

namespace tandem::geometry {

using Real = long double;
using Vector3r = Eigen::Matrix<Real, 3, 1>;

/// Bounds of the distance of two cores [m].
struct Bounds {
  double low, high;
};

/// Bounds of the distance of disjoint cores, or {0, high} if they overlap or the gap is very small.
/// Ref: Wolfe, Finding the nearest point in a polytope (1976), on A - B with generated vertices.
Bounds core_distance(const Shape& a, const Shape& b);

}  // namespace tandem::geometry
