#pragma once
/// How far apart two cores are along a direction, and the direction that sets them furthest apart.

#include "tandem/geometry/orthotope.h"

namespace tandem::geometry::detail {

/// Gap of the cores seen along a unit vector: least of A minus greatest of B. It never exceeds
/// their distance, and reaches it, the depth with a minus sign in overlap, at the best `nhat`.
struct Separation {
  Eigen::Vector3d nhat_BA_W;
  double gap;  ///< [m]
};

/// @param nhat [-] unit.   @return gap [m] of the cores along it.
double separation(const Shape& a, const Shape& b, const Eigen::Vector3d& nhat);

/// Keeps the best of the directions it is shown.
class DirectionSearch {
 public:
  DirectionSearch(const Shape& a, const Shape& b) : a_(a), b_(b), p_ba_(a.origin() - b.origin()) {}

  /// Looks along `n`, of any length, both ways; not at all if it is zero.
  void consider(const Eigen::Vector3d& n);

  const Separation& best() const { return best_; }
  bool found_any() const { return best_.gap > kNone; }

 private:
  void keep(const Eigen::Vector3d& nhat, double gap) {
    if (gap > best_.gap) best_ = {nhat, gap};
  }

  static constexpr double kNone = -std::numeric_limits<double>::max();

  const Shape& a_;
  const Shape& b_;
  Eigen::Vector3d p_ba_;
  Separation best_{Eigen::Vector3d::UnitZ(), kNone};
};

/// The best separation of cores that overlap, touch, or are so near (1e-8 m) that `nearest` alone
/// says little about the direction.
Separation best_separation(const Shape& a, const Shape& b, const Nearest& nearest);

}  // namespace tandem::geometry::detail
