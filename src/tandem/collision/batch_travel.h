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

/// How a point moves within a part of an edge: from the middle to either end by `step` one way or
/// the other, to first order, and by no more than `bend` beside that.
struct Travel {
  V3 step;
  float bend;  ///< [m]
  /// Most distance from where it is at the middle.
  HWY_INLINE V Length() const { return hn::Add(hn::Sqrt(Dot(step, step)), Fill(bend)); }
};

/// Upper bounds of travel within the parts of an edge whose middles are placed.
///
/// On a straight edge q(s) = q + s d a point p moves with p' = sum_j d_j a_j x (p - o_j), and
/// |p''| <= sum_j |d_j| l_j (2 sum_{i above j} |d_i| + |d_j|) with its distance l_j from axis j:
/// each derivative by a joint above turns the one below. Prismatic joints have l_j = 1 and turn
/// nothing. Ref: docs/methods.md, "Batches".
class Travels {
 public:
  Travels(const BatchPairs& pairs, BatchChecker::Scratch& work)
      : pairs_(pairs), work_(work), model_(work.model) {}

  /// Bounds what follows, per unit of s.
  void Bound() {
    const auto depth = static_cast<std::size_t>(model_.depth);
    for (const int j : pairs_.joints) {
      const auto g = static_cast<std::size_t>(j);
      const BatchJoint& joint = model_.joints[g];
      const auto value = static_cast<float>(std::abs(work_.value_half[g]));
      work_.deviation[g] = kRoundUp * value;
      work_.turn[g] = TurnAbove(joint) + (joint.prismatic ? 0.0F : work_.deviation[g]);
      float travel = 0, bend = 0;
      for (int k = j; k >= 0; k = model_.joints[static_cast<std::size_t>(k)].parent) {
        const auto i = static_cast<std::size_t>(k);
        const BatchJoint& above = model_.joints[i];
        const std::size_t at = g * depth + static_cast<std::size_t>(above.depth - 1);
        const float moved = model_.levers[at] * work_.deviation[i];
        travel += moved;
        bend += moved * (TurnAbove(above) + work_.turn[i]);
        work_.travel[at] = travel;
        work_.bend[at] = kRoundUp * bend;
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

  /// To be called when a block is placed: its twists are computed when first asked for.
  void Placed() { placed_twists_ = false; }

  /// Of a point p of `joint`, at most `offset` from its group's centre, seen from the frame of
  /// `common` above.
  HWY_INLINE Travel OfPoint(const V3& p, int joint, int common, float offset) {
    if (joint == common) return {Fill({0, 0, 0}), 0};
    const Twist twist = TwistOf(joint, common);
    return {twist.linear + Cross(twist.angular, p), BendOf(joint, common, offset)};
  }

  /// How far `joint` turns in the frame of `common` [rad]: two points of it move no further apart
  /// than this times their distance.
  HWY_INLINE V TurnOf(int joint, int common) {
    if (joint == common) return hn::Zero(kFloats);
    const V3 angular = TwistOf(joint, common).angular;
    const float half_turn = static_cast<float>(work_.half_length) * TurnBetween(joint, common);
    return hn::MulAdd(hn::Sqrt(Dot(angular, angular)), Fill(kRoundUp),
                      Fill(0.5F * half_turn * half_turn + kRoundUp * Slack(half_turn)));
  }

 private:
  /// Covers the rounding of bounds [-].
  static constexpr float kRoundUp = 1 + 1e-5F;

  /// Velocities in C: of points p that are fixed to a joint linear + angular x p, per half part.
  struct Twist {
    V3 angular, linear;
  };

  HWY_INLINE float TurnAbove(const BatchJoint& joint) const {
    return joint.parent < 0 ? 0.0F : work_.turn[static_cast<std::size_t>(joint.parent)];
  }
  /// Per unit of s.
  HWY_INLINE float TurnBetween(int joint, int common) const {
    return work_.turn[static_cast<std::size_t>(joint)] -
           (common < 0 ? 0.0F : work_.turn[static_cast<std::size_t>(common)]);
  }

  /// What single precision may have lost of a velocity, at a turn in this part [m or rad].
  HWY_INLINE float Slack(float half_turn) const { return 0.5F * model_.margin * half_turn; }

  float BendOf(int joint, int common, float offset) const {
    const auto shared = static_cast<std::size_t>(model_.depth_of(common));
    const std::size_t at =
        static_cast<std::size_t>(joint) * static_cast<std::size_t>(model_.depth) + shared;
    const float turn = TurnBetween(joint, common), travel = work_.travel[at];
    const float above = common < 0 ? 0.0F : work_.turn[static_cast<std::size_t>(common)];
    const float second = std::max(0.0F, work_.bend[at] - 2 * above * travel) + offset * turn * turn;
    const auto half = static_cast<float>(work_.half_length);
    return kRoundUp * half * (0.5F * half * second + 1e-5F * (travel + offset * turn)) +
           Slack(half * turn);
  }

  HWY_INLINE Twist Load(int joint) const {
    const LaneRow* rows = &work_.twists[6 * static_cast<std::size_t>(joint)];
    return {Load3(rows), Load3(rows + 3)};
  }
  HWY_INLINE Twist TwistOf(int joint, int common) {
    if (!placed_twists_) PlaceTwists();
    const Twist twist = Load(joint);
    if (common < 0) return twist;
    const Twist above = Load(common);
    return {twist.angular - above.angular, twist.linear - above.linear};
  }

  HWY_NOINLINE void PlaceTwists() {
    for (const int j : pairs_.joints) {
      const auto i = static_cast<std::size_t>(j);
      const BatchJoint& joint = model_.joints[i];
      const LaneRow* pose = &work_.poses[12 * i];
      const V d = Fill(static_cast<float>(work_.half_length * work_.value_half[i]));
      const V3 axis = Scale(d, Load3(pose + 6));
      Twist twist{Fill({0, 0, 0}), Fill({0, 0, 0})};
      if (joint.parent >= 0) twist = Load(joint.parent);
      if (joint.prismatic) {
        twist.linear = twist.linear + axis;
      } else {
        twist.angular = twist.angular + axis;
        twist.linear = twist.linear + Cross(Load3(pose + 9), axis);
      }
      LaneRow* rows = &work_.twists[6 * i];
      Store3(twist.angular, rows);
      Store3(twist.linear, rows + 3);
    }
    placed_twists_ = true;
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  bool placed_twists_ = false;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
