#pragma once
/// Two cylinders: the one pair whose contact, rim against rim, has no closed form.

#include "tandem/geometry/separation.h"

namespace tandem::geometry::detail {

/// Nearest points of two cylinder cores, if they are disjoint or only touch.
Nearest nearest_cylinders(const Shape& a, const Shape& b);

/// Shows `search` the best separation with a rim on a rim, if it improves on what it has.
void search_rim_pairs(const Shape& a, const Shape& b, DirectionSearch& search);

}  // namespace tandem::geometry::detail
