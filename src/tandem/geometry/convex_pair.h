#pragma once
/// Pairs of which one core is a convex polytope with any number of faces.

#include "tandem/geometry/separation.h"

namespace tandem::geometry::detail {

/// Nearest points of any core and a convex one, or the other way round, if they are disjoint or
/// only touch. Where they overlap it may miss that: check with `separation`.
Nearest nearest_with_convex(const Shape& a, const Shape& b);

/// Shows `search` the directions in which cores that overlap or nearly touch, at least one of them
/// convex, may be least apart.
void search_convex(const Shape& a, const Shape& b, DirectionSearch& search);

}  // namespace tandem::geometry::detail
