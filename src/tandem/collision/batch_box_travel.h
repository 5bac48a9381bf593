// How far things move while joints deviate. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_BOX_TRAVEL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_BOX_TRAVEL_H
#undef TANDEM_COLLISION_BATCH_BOX_TRAVEL_H
#else
#define TANDEM_COLLISION_BATCH_BOX_TRAVEL_H
#endif

#include "tandem/collision/batch_place.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Covers the rounding of bounds [-].
inline constexpr float kBoxRoundUp = 1 + 1e-5F;

/// Upper bounds of travel away from the placed configurations, where every joint may deviate in
/// every lane by its own Scratch::box_deviation. Ref: docs/methods.md, "Continuous-time
/// certificate".
class BoxTravels {
 public:
  BoxTravels(const BatchPairs& pairs, BatchChecker::Scratch& work, Placement& placement)
      : pairs_(pairs), work_(work), model_(work.model), placement_(placement) {}

  /// Bounds what follows; to be called when Scratch::box_deviation has changed.
  void Bound() {
    const auto depth = static_cast<std::size_t>(model_.depth);
    for (const int j : pairs_.joints) {
      const auto g = static_cast<std::size_t>(j);
      const BatchJoint& joint = model_.joints[g];
      V turn = joint.prismatic ? hn::Zero(kFloats) : Load(work_.box_deviation[g]);
      if (joint.parent >= 0) {
        turn = hn::Add(turn, Load(work_.box_turn[static_cast<std::size_t>(joint.parent)]));
      }
      Store(turn, work_.box_turn[g]);
      V sum = hn::Zero(kFloats);
      for (int k = j; k >= 0; k = model_.joints[static_cast<std::size_t>(k)].parent) {
        const auto i = static_cast<std::size_t>(k);
        const auto d = static_cast<std::size_t>(model_.joints[i].depth - 1);
        sum = hn::MulAdd(Fill(model_.levers[g * depth + d]), Load(work_.box_deviation[i]), sum);
        Store(sum, work_.box_travel[g * depth + d]);
      }
    }
  }

  /// Of a group's centre by the joints below depth `shared`, whatever is placed.
  HWY_INLINE V OfGroup(int group, int shared) const {
    const auto g = static_cast<std::size_t>(group);
    if (model_.joints[g].depth <= shared) return hn::Zero(kFloats);
    const auto depth = static_cast<std::size_t>(model_.depth);
    return hn::Mul(Fill(kBoxRoundUp),
                   Load(work_.box_travel[g * depth + static_cast<std::size_t>(shared)]));
  }
  HWY_INLINE V OfItem(const BatchItem& item) const {
    const V travel = OfGroup(item.group_a, item.shared);
    return item.group_b < 0 ? travel : hn::Add(travel, OfGroup(item.group_b, item.shared));
  }

  /// Upper bound of how far a point of `joint` moves by the joints below `common`. From the placed
  /// configuration the joints are moved one after the other, base first: the distance of the point
  /// from the axis of each depends on the joints between only, which still stand.
  HWY_NOINLINE V OfPoint(const V3& p, int joint, int common) {
    V sum = hn::Zero(kFloats);
    for (int j = joint; j != common; j = model_.joints[static_cast<std::size_t>(j)].parent) {
      const auto i = static_cast<std::size_t>(j);
      const V deviation = Load(work_.box_deviation[i]);
      if (model_.joints[i].prismatic) {
        sum = hn::Add(sum, deviation);
        continue;
      }
      const LaneRow* rows = &work_.poses[12 * i];
      const V3 arm = Cross(Load3(rows + 6), p - Load3(rows + 9));
      sum = hn::MulAdd(deviation, hn::Sqrt(Dot(arm, arm)), sum);
    }
    return hn::Mul(sum, Fill(kBoxRoundUp));
  }

  /// How far the joints below `common` turn `joint` [rad]: two points of it move no further apart
  /// than this times their distance.
  HWY_INLINE V TurnOf(int joint, int common) const {
    V turn = Load(work_.box_turn[static_cast<std::size_t>(joint)]);
    if (common >= 0) turn = hn::Sub(turn, Load(work_.box_turn[static_cast<std::size_t>(common)]));
    return hn::Mul(turn, Fill(kBoxRoundUp));
  }

  /// As OfPoint, of the centre of a group or of a body.
  V OfGroupCenter(int group, int common) {
    return Kept(work_.group_travel, work_.group_travel_time, group, common,
                [&]() HWY_ATTR { return OfPoint(placement_.GroupCenter(group), group, common); });
  }
  V OfBodyCenter(int body, int common) {
    return Kept(work_.body_travel, work_.body_travel_time, body, common, [&]() HWY_ATTR {
      return OfPoint(placement_.BodyCenter(body),
                     model_.bodies[static_cast<std::size_t>(body)].joint, common);
    });
  }
  /// As OfPoint for all points of a shape's core.
  V OfShape(int shape, int common) {
    return Kept(work_.shape_travel, work_.shape_travel_time, shape, common,
                [&]() HWY_ATTR { return OfCore(shape, common); });
  }

 private:
  /// What does not depend on a common joint is computed once per placement.
  template <class F>
  HWY_INLINE V Kept(std::vector<LaneRow>& rows, std::vector<std::uint32_t>& times, int index,
                    int common, F&& compute) {
    if (common >= 0) return compute();
    const auto i = static_cast<std::size_t>(index);
    if (times[i] != work_.now) {
      Store(compute(), rows[i]);
      times[i] = work_.now;
    }
    return Load(rows[i]);
  }

  /// The sum is convex, so most at the core's ends.
  HWY_NOINLINE V OfCore(int shape, int common) {
    const BatchShape& compiled = model_.shapes[static_cast<std::size_t>(shape)];
    if (compiled.joint == common) return hn::Zero(kFloats);
    const V3 center = placement_.CenterOf(shape);
    if (compiled.core == BatchCore::kPoint) return OfPoint(center, compiled.joint, common);
    if (compiled.core == BatchCore::kSegment) {
      const V3 u = placement_.HalfVectorOf(shape);
      return hn::Max(OfPoint(center + u, compiled.joint, common),
                     OfPoint(center - u, compiled.joint, common));
    }
    return hn::MulAdd(TurnOf(compiled.joint, common), Fill(compiled.circumradius),
                      OfPoint(center, compiled.joint, common));
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  Placement& placement_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
