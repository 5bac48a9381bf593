#pragma once
/// Nearest points of convex cores known by their support points alone.

#include "tandem/geometry/orthotope.h"

namespace tandem::geometry::detail {

/// Nearest points of two cores of any type; coincident points if the cores overlap.
/// Ref: Gilbert, Johnson, Keerthi, A fast procedure for computing the distance between complex
/// objects in three-dimensional space (1988).
Nearest nearest_by_support(const Shape& a, const Shape& b);

}  // namespace tandem::geometry::detail
