#pragma once
/// Least translation of overlapping convex cores known by their support points alone.

#include "tandem/geometry/separation.h"

namespace tandem::geometry::detail {

/// The best separation of cores that overlap or nearly touch, at least one of them with volume, not
/// worse than `guess`. The polytope grows inside B - A until its nearest facet is a facet of it.
/// Ref: van den Bergen, Proximity queries and penetration depth computation on 3D game objects
/// (2001).
Separation expand_polytope(const Shape& a, const Shape& b, const Separation& guess);

}  // namespace tandem::geometry::detail
