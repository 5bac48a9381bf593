// How far things move along a part of an edge. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_TRAVEL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_TRAVEL_H
#undef TANDEM_COLLISION_BATCH_TRAVEL_H
#else
#define TANDEM_COLLISION_BATCH_TRAVEL_H
#endif

#include "tandem/collision/batch_place.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Upper bounds of travel within the parts of an edge whose middles are placed.
/// Ref: docs/methods.md, "Continuous-time certificate".
class Travels {
 public:
  Travels(const BatchPairs& pairs, BatchChecker::Scratch& work, Placement& placement)
      : pairs_(pairs), work_(work), model_(work.model), placement_(placement) {}

  /// Bounds what follows, per unit of s.
  void Bound() {
    const auto depth = static_cast<std::size_t>(model_.depth);
    for (const int j : pairs_.joints) {
      const auto g = static_cast<std::size_t>(j);
      const BatchJoint& joint = model_.joints[g];
      const auto value = static_cast<float>(std::abs(work_.value_half[g]));
      work_.deviation[g] = kRoundUp * value;
      const float above =
          joint.parent < 0 ? 0.0F : work_.turn[static_cast<std::size_t>(joint.parent)];
      work_.turn[g] = above + (joint.prismatic ? 0.0F : work_.deviation[g]);
      float sum = 0;
      for (int k = j; k >= 0; k = model_.joints[static_cast<std::size_t>(k)].parent) {
        const auto i = static_cast<std::size_t>(k);
        const auto d = static_cast<std::size_t>(model_.joints[i].depth - 1);
        sum += model_.levers[g * depth + d] * work_.deviation[i];
        work_.travel[g * depth + d] = sum;
      }
    }
  }

  /// Per unit of s, over all configurations.
  HWY_INLINE float GroupTravel(int group, int shared) const {
    const auto g = static_cast<std::size_t>(group);
    if (model_.joints[g].depth <= shared) return 0;
    return work_
        .travel[g * static_cast<std::size_t>(model_.depth) + static_cast<std::size_t>(shared)];
  }
  HWY_INLINE float OfItem(const BatchItem& item) const {
    const float travel = GroupTravel(item.group_a, item.shared);
    return item.group_b < 0 ? travel : travel + GroupTravel(item.group_b, item.shared);
  }

  /// Upper bound of how far a point of `joint` moves by the joints below `common` within a part.
  /// From the middle the joints are moved one after the other, base first: the distance of the
  /// point from the axis of each depends on the joints between only, which still stand.
  HWY_NOINLINE V OfPoint(const V3& p, int joint, int common) {
    V sum = hn::Zero(kFloats);
    for (int j = joint; j != common; j = model_.joints[static_cast<std::size_t>(j)].parent) {
      const auto i = static_cast<std::size_t>(j);
      const V deviation = Fill(work_.deviation[i]);
      if (model_.joints[i].prismatic) {
        sum = hn::Add(sum, deviation);
        continue;
      }
      const LaneRow* rows = &work_.poses[12 * i];
      const V3 arm = Cross(Load3(rows + 6), p - Load3(rows + 9));
      sum = hn::MulAdd(deviation, hn::Sqrt(Dot(arm, arm)), sum);
    }
    return hn::Mul(sum, Fill(kRoundUp * static_cast<float>(work_.half_length)));
  }

  /// How far the joints below `common` turn `joint` within a part [rad]: two points of it move no
  /// further apart than this times their distance.
  HWY_INLINE float TurnOf(int joint, int common) const {
    const float turn = work_.turn[static_cast<std::size_t>(joint)] -
                       (common < 0 ? 0.0F : work_.turn[static_cast<std::size_t>(common)]);
    return kRoundUp * static_cast<float>(work_.half_length) * turn;
  }

  /// The same for all points of a shape's core: the sum is convex, so most at its ends.
  V OfShape(int shape, int common) {
    const BatchShape& compiled = model_.shapes[static_cast<std::size_t>(shape)];
    if (compiled.joint == common) return hn::Zero(kFloats);
    const LaneRow* rows = placement_.Shape(shape);
    const V3 center = Load3(rows);
    if (compiled.core == BatchCore::kPoint) return OfPoint(center, compiled.joint, common);
    if (compiled.core == BatchCore::kSegment) {
      const V3 u = Load3(rows + 3);
      return hn::Max(OfPoint(center + u, compiled.joint, common),
                     OfPoint(center - u, compiled.joint, common));
    }
    return hn::Add(OfPoint(center, compiled.joint, common),
                   Fill(TurnOf(compiled.joint, common) * compiled.circumradius));
  }

 private:
  /// Covers the rounding of bounds [-].
  static constexpr float kRoundUp = 1 + 1e-5F;

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  Placement& placement_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
