// Questions about one block of configurations. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_CHECK_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_CHECK_H
#undef TANDEM_COLLISION_BATCH_CHECK_H
#else
#define TANDEM_COLLISION_BATCH_CHECK_H
#endif

#include <bit>

#include "tandem/collision/batch_gap.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Whether anything touches in any lane, from groups down to shapes.
class BlockChecker {
 public:
  BlockChecker(const BatchPairs& pairs, BatchChecker::Scratch& work)
      : pairs_(pairs),
        work_(work),
        model_(work.model),
        placement_(work),
        gaps_(model_, placement_) {}

  Placement& placement() { return placement_; }
  Gaps& gaps() { return gaps_; }

  /// From the standing body's box to a point, and the squared distance.
  HWY_INLINE V3 FromStanding(const BatchItem& item, const V3& p) const {
    return FromBox(p - Fill(item.center), Fill(item.half));
  }
  HWY_INLINE V StandingGap(const BatchItem& item, const V3& p) const {
    const V3 e = FromStanding(item, p);
    return Dot(e, e);
  }
  HWY_INLINE V ItemGap(const BatchItem& item) const {
    const V3 center = placement_.GroupCenter(item.group_a);
    if (item.group_b < 0) return StandingGap(item, center);
    const V3 r = center - placement_.GroupCenter(item.group_b);
    return Dot(r, r);
  }

  /// Calls f(item) with indices of items until it returns true; not with those of standing bodies
  /// in boxes that are far from a group in all lanes.
  /// @param is_far  of a group, its radius, and the squared distance of its centre from the box.
  /// @return whether f has.
  template <class IsFar, class F>
  HWY_INLINE bool AnyItem(IsFar&& is_far, F&& f) {
    for (const BatchGroupItems& of_group : pairs_.standing_groups) {
      if (of_group.nodes.empty()) {
        if (AnyOf(of_group.first, of_group.count, f)) return true;
        continue;
      }
      const V3 center = placement_.GroupCenter(of_group.group);
      const float radius = model_.groups[static_cast<std::size_t>(of_group.group)].radius;
      const auto count = static_cast<int>(of_group.nodes.size());
      for (int n = 0; n < count;) {
        const BatchNode& node = of_group.nodes[static_cast<std::size_t>(n)];
        const V squared = PointBox(center - Fill(node.center), Fill(node.half));
        if (is_far(of_group.group, radius, squared)) {
          n = node.skip;
          continue;
        }
        if (AnyOf(node.first, node.count, f)) return true;
        ++n;
      }
    }
    const auto standing = static_cast<int>(pairs_.standing_items);
    return AnyOf(standing, static_cast<int>(pairs_.items.size()) - standing, f);
  }

  /// Whether an item touches in any lane.
  bool Touches(const BatchItem& item) {
    return hn::AllTrue(kFloats, hn::Gt(ItemGap(item), Fill(item.reach * item.reach)))
               ? false
               : Descend(item);
  }

  /// Lanes whose joint values are known to keep the two groups of a map apart, and stay so within
  /// these deviations. Values are inside the joint limits, or not known of.
  HWY_INLINE Mask KnownFree(const JointMap& map, V deviation_u, V deviation_v) const {
    const hn::Rebind<std::int32_t, Floats> ints;
    const auto cell_of = [&](std::size_t axis) HWY_ATTR {
      const V value = Load(work_.values[static_cast<std::size_t>(map.joints[axis])]);
      return hn::Mul(hn::Sub(value, Fill(map.low[axis])), Fill(map.cells_per_unit[axis]));
    };
    const V u = cell_of(0), v = cell_of(1), side = Fill(JointMap::kSide);
    const Mask inside = hn::And(hn::And(hn::Ge(u, hn::Zero(kFloats)), hn::Lt(u, side)),
                                hn::And(hn::Ge(v, hn::Zero(kFloats)), hn::Lt(v, side)));
    const auto row = hn::ConvertTo(ints, hn::IfThenElseZero(inside, u));
    const auto column = hn::ConvertTo(ints, hn::IfThenElseZero(inside, v));
    const auto cell = hn::Add(hn::Mul(row, hn::Set(ints, JointMap::kSide)), column);
    alignas(sizeof(LaneRow)) std::int32_t cells[kMostLanes];
    hn::Store(cell, ints, cells);
    LaneRow rooms{};
    for (int lane = 0; lane < kLanes; ++lane) {
      rooms.lane[lane] = map.room[static_cast<std::size_t>(cells[lane])];
    }
    const V room = Load(rooms);
    const V needed = hn::Max(hn::Mul(deviation_u, Fill(map.cells_per_unit[0])),
                             hn::Mul(deviation_v, Fill(map.cells_per_unit[1])));
    return hn::And(inside, hn::Le(needed, room));
  }

  /// The same where the spheres around the groups do not tell.
  HWY_NOINLINE bool Descend(const BatchItem& item) {
    Mask open = hn::Eq(Fill(0), Fill(0));
    if (item.joint_map) {
      open = hn::Not(KnownFree(*item.joint_map, hn::Zero(kFloats), hn::Zero(kFloats)));
      if (None(open)) return false;
    }
    for (int i = item.first; i < item.first + item.count; ++i) {
      const BatchBodyPair& pair = pairs_.body_pairs[static_cast<std::size_t>(i)];
      if (item.group_b < 0 ? TouchesStanding(item, pair) : TouchesMoving(pair, open)) return true;
    }
    return false;
  }

 private:
  template <class F>
  HWY_INLINE static bool AnyOf(int first, int count, F& f) {
    for (int i = first; i < first + count; ++i) {
      if (f(i)) return true;
    }
    return false;
  }

  const BatchBody& BodyAt(int body) const { return model_.bodies[static_cast<std::size_t>(body)]; }

  /// Whether squared distances are beyond a sum of radii in all lanes,
  HWY_INLINE static bool Apart(V squared, float reach) {
    return All(hn::Gt(squared, Fill(reach * reach)));
  }
  /// or in those that are open.
  HWY_INLINE static bool Apart(Mask open, V squared, float reach) {
    return None(hn::And(open, hn::Le(squared, Fill(reach * reach))));
  }

  bool TouchesStanding(const BatchItem& item, const BatchBodyPair& pair) {
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = placement_.BodyCenter(pair.a);
    const float radius = body.sphere.radius;
    if (model_.group_sizes[static_cast<std::size_t>(body.joint)] > 1 &&
        Apart(StandingGap(item, center), radius + BodyAt(pair.b).outer)) {
      return false;
    }
    unsigned resolved = 0;
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      if (Apart(gaps_.PointTo(center, other), radius + gaps_.ShapeAt(other).outer)) continue;
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        if (TouchesShape(s, other, pair.pair, hn::Eq(Fill(0), Fill(0)), resolved)) return true;
      }
    }
    return false;
  }

  bool TouchesMoving(const BatchBodyPair& pair, Mask open) {
    const BatchBody& a = BodyAt(pair.a);
    const BatchBody& b = BodyAt(pair.b);
    const V3 center_a = placement_.BodyCenter(pair.a), center_b = placement_.BodyCenter(pair.b);
    const V3 r = center_a - center_b;
    if (Apart(open, Dot(r, r), a.sphere.radius + b.sphere.radius)) return false;
    unsigned resolved = 0;
    for (int s = a.first_shape; s < a.first_shape + a.shape_count; ++s) {
      if (a.shape_count > 1 &&
          Apart(open, gaps_.PointTo(center_b, s), b.sphere.radius + gaps_.ShapeAt(s).outer)) {
        continue;
      }
      if (b.is_spheres && gaps_.ShapeAt(s).core == BatchCore::kPoint &&
          ApartFromSpheres(s, b, open)) {
        continue;
      }
      for (int t = b.first_shape; t < b.first_shape + b.shape_count; ++t) {
        if (TouchesShape(s, t, pair.pair, open, resolved)) return true;
      }
    }
    return false;
  }

  /// Whether a sphere is apart from a body of spheres; most are, so all are looked at together.
  HWY_INLINE bool ApartFromSpheres(int sphere, const BatchBody& body, Mask open) {
    const V3 center = gaps_.Center(sphere);
    const float outer = gaps_.ShapeAt(sphere).outer;
    V least = Fill(1);
    for (int t = body.first_shape; t < body.first_shape + body.shape_count; ++t) {
      const V3 r = center - gaps_.Center(t);
      const float reach = outer + gaps_.ShapeAt(t).outer;
      least = hn::Min(least, hn::Sub(Dot(r, r), Fill(reach * reach)));
    }
    return None(hn::And(open, hn::Le(least, hn::Zero(kFloats))));
  }

  /// @param resolved  lanes in which the exact checker found the bodies apart.
  HWY_INLINE bool TouchesShape(int a, int b, int pair, Mask open, unsigned& resolved) {
    const BatchShape& shape_a = gaps_.ShapeAt(a);
    const float outer = shape_a.outer + gaps_.ShapeAt(b).outer;
    // Of points this is the distance itself.
    if (Apart(open, gaps_.PointTo(gaps_.Center(a), b), outer + shape_a.circumradius)) return false;
    const Gap gap = gaps_.Between(a, b, Fill(outer));
    const Mask near = hn::And(open, hn::Le(gap.squared, Fill(outer * outer)));
    if (None(near)) return false;
    if (!None(hn::And(open, hn::Lt(gap.upper, Fill(gap.touch_below))))) return true;
    for (unsigned lanes = Bits(near) & ~resolved; lanes != 0; lanes &= lanes - 1) {
      if (work_.touches_exactly(pair, std::countr_zero(lanes))) return true;
    }
    resolved |= Bits(near);
    return false;
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  Placement placement_;
  Gaps gaps_;
};

/// Whether the configurations that Scratch::values holds are free.
bool IsPlacedBlockFree(const BatchPairs& pairs, BatchChecker::Scratch& work) {
  BlockChecker checker(pairs, work);
  checker.placement().Place(pairs);
  const auto hit = [&](int item) HWY_ATTR {
    if (!checker.Touches(pairs.items[static_cast<std::size_t>(item)])) return false;
    work.last_hit = item;
    return true;
  };
  if (0 <= work.last_hit && work.last_hit < static_cast<int>(pairs.items.size()) &&
      hit(work.last_hit)) {
    return false;
  }
  const auto is_far = [](int, float radius, V squared)
                          HWY_ATTR { return All(hn::Gt(squared, Fill(radius * radius))); };
  return !checker.AnyItem(is_far, hit);
}

/// Fills Scratch::values from the columns of Scratch::Q.
void LoadValues(const BatchPairs& pairs, BatchChecker::Scratch& work) {
  const BatchModel& model = work.model;
  for (const int j : pairs.joints) {
    const BatchJoint& joint = model.joints[static_cast<std::size_t>(j)];
    LaneRow& row = work.values[static_cast<std::size_t>(j)];
    for (int lane = 0; lane < kLanes; ++lane) {
      const double q = work.Q[std::min(lane, work.count - 1) * work.stride + joint.column];
      row.lane[lane] =
          static_cast<float>(without_turns(joint, joint.multiplier * q + joint.offset));
    }
  }
}

bool IsBlockFree(const BatchPairs& pairs, BatchChecker::Scratch& work) {
  LoadValues(pairs, work);
  return IsPlacedBlockFree(pairs, work);
}

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
