#pragma once
/// Random shapes of every type, with a liking for degenerate ones.

#include <Eigen/Geometry>
#include <array>
#include <string>

#include "tandem/core/rng.h"
#include "tandem/geometry/shape.h"

namespace tandem::geometry {

inline constexpr std::array kCoreTypes{
    CoreType::kPoint, CoreType::kSegment,  CoreType::kTriangle, CoreType::kRectangle,
    CoreType::kBox,   CoreType::kCylinder, CoreType::kConvex};

/// How shapes are drawn.
enum class Draw {
  kGeneric,  ///< Any pose, sizes of the same order.
  kSlender,  ///< Any pose, sizes over five decades, some zero.
  kGrid,     ///< Axes along W's, coordinates on a coarse grid: parallel, coplanar, touching, equal.
  kTilted,   ///< The grid, turned as a whole by one rotation: as above, with rounding.
  kWobbled,  ///< The grid, every shape turned by about 1e-9 rad: all but parallel.
};
inline constexpr std::array kDraws{Draw::kGeneric, Draw::kSlender, Draw::kGrid, Draw::kTilted,
                                   Draw::kWobbled};
const char* to_string(Draw draw);

Eigen::Vector3d random_point(Rng& rng, double reach);
Eigen::Vector3d random_direction(Rng& rng);
Eigen::Matrix3d random_rotation(Rng& rng);
Eigen::Isometry3d random_pose(Rng& rng, double reach);

/// A shape about [-spread, spread]^3 [m] of size up to about 1 m.
Shape random_shape(Rng& rng, CoreType type, Draw draw, double spread);

/// Distance of `p` to the core [m], 0 inside; written apart from the library.
double distance_to_core(const Shape& shape, const Eigen::Vector3d& p);

/// For failure messages: type, origin, extents and radii with all digits.
std::string describe(const Shape& shape);

}  // namespace tandem::geometry
