#pragma once
/// Private to this folder: how large and small lengths may be.

namespace tandem::geometry::detail {

// Far beyond any cell. Products of several stay finite: a distance that overflows compares like
// one between bodies that are apart.
inline constexpr double kLargest = 1e50;    ///< [m] Coordinates and sizes.
inline constexpr double kSmallest = 1e-50;  ///< [m] Sizes that are not 0.

}  // namespace tandem::geometry::detail
