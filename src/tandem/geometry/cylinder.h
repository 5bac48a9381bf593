#pragma once
/// Nearest points of a cylinder and another core.

#include "tandem/geometry/separation.h"

namespace tandem::geometry::detail {

/// Nearest points of `p` (as A) and a cylinder core.
Nearest nearest_point_cylinder(const Eigen::Vector3d& p, const Shape& b);

/// Nearest points of a segment (as A) and a cylinder core; coincident points if they overlap.
Nearest nearest_segment_cylinder(const Segment& a, const Shape& b);

/// Nearest points of a triangle, rectangle, box or cylinder core and a cylinder core, if they are
/// disjoint or only touch. Where they overlap it may miss that: check with `separation`.
Nearest nearest_with_cylinder(const Shape& a, const Shape& b);

/// Shows `search` every direction in which cores that overlap, at least one of them a cylinder,
/// may be least apart with a curved part of a cylinder's surface in touch.
void search_curved(const Shape& a, const Shape& b, DirectionSearch& search);

}  // namespace tandem::geometry::detail
