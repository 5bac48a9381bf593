#pragma once
/// What is refused as a mistake, long before arithmetic overflows.

namespace tandem {

/// [m] or [rad], of positions in a parent frame and of joints. Beyond lies no place on Earth in any
/// of its grids, and a double resolves less than 10 nanometres.
inline constexpr double kFarthest = 1e8;

}  // namespace tandem
