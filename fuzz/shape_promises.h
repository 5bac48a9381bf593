#pragma once
/// What every geometry::Shape that was read from a file holds.

#include <cmath>

#include "support.h"
#include "tandem/geometry/shape.h"

namespace tandem::fuzz {

inline void check_shape(const geometry::Shape& shape) {
  require(shape.origin().allFinite() && shape.extents().allFinite(), "shapes are finite");
  require(std::isfinite(shape.radius()) && shape.radius() >= 0, "radii are not negative");
  require(shape.inverse_squares().allFinite(), "extents can be projected on");
  require(std::isfinite(shape.volume()) && shape.volume() > 0, "shapes have a volume");
}

}  // namespace tandem::fuzz
