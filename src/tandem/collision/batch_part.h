// Which pairs are free all along which parts of an edge. Compiled once per instruction set; private
// to batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_PART_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_PART_H
#undef TANDEM_COLLISION_BATCH_PART_H
#else
#define TANDEM_COLLISION_BATCH_PART_H
#endif

#include "tandem/collision/batch_check.h"
#include "tandem/collision/batch_travel.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Lanes are the middles of parts of an edge, all of one length. A pair that is further apart at
/// the middle than it can move within the part is free there.
/// Ref: docs/methods.md, "Continuous-time certificate".
class PartProver {
 public:
  PartProver(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work)
      : pairs_(pairs),
        work_(work),
        model_(work.model),
        checker_(pairs, work),
        gaps_(checker_.gaps()),
        travels_(pairs, work),
        want_clearance_(want_clearance),
        least_(Fill(static_cast<float>(BatchChecker::kClearanceCap))) {
    travels_.Bound();
  }

  BlockChecker& checker() { return checker_; }
  const Travels& travels() const { return travels_; }
  bool touches() const { return touches_; }          ///< Some lane of what was asked last.
  bool is_hopeless() const { return is_hopeless_; }  ///< No division parts what was asked so far.
  V least() const { return least_; }                 ///< Clearance of what is proven.

  /// Places a block at Scratch::s.
  void Place() {
    LaneRow single{};
    for (int lane = 0; lane < kLanes; ++lane) single.lane[lane] = static_cast<float>(work_.s[lane]);
    const V s = Load(single);
    for (const int j : pairs_.joints) {
      const auto i = static_cast<std::size_t>(j);
      const V half = Fill(static_cast<float>(work_.value_half[i]));
      Store(hn::MulAdd(s, half, Fill(static_cast<float>(work_.value_middle[i]))), work_.values[i]);
    }
    checker_.placement().Place(pairs_);
    travels_.Placed();
  }

  /// Whether squared distances exceed what things move at most, in all lanes.
  HWY_INLINE bool IsFarApart(V squared, float inflated) {
    if (!All(hn::Gt(squared, Fill(inflated * inflated)))) return false;
    if (want_clearance_) least_ = hn::Min(least_, hn::Sub(hn::Sqrt(squared), Fill(inflated)));
    return true;
  }

  /// Lanes in which the item is not proven apart all along its part; sets touches().
  HWY_NOINLINE Mask Unproven(const BatchItem& item) {
    touches_ = false;
    const V squared = checker_.ItemGap(item);
    const V travel = Fill(static_cast<float>(work_.half_length) * travels_.OfItem(item));
    Mask open = Within(hn::Eq(travel, travel), squared, item.reach, travel);
    if (None(open)) return open;
    if (item.joint_map && !want_clearance_) {
      open = hn::AndNot(KnownFree(*item.joint_map), open);
      if (None(open)) return open;
    }
    open = item.group_b < 0 ? NearStanding(item, open) : NearMoving(item, open);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = item.first; i < item.first + item.count && !touches_; ++i) {
      const BatchBodyPair& pair = pairs_.body_pairs[static_cast<std::size_t>(i)];
      // A lane that is left to its parts anyway is not looked at further.
      const Mask among = hn::AndNot(unproven, open);
      if (None(among)) break;
      unproven = hn::Or(unproven, item.group_b < 0 ? UnprovenStanding(pair, among)
                                                   : UnprovenMoving(pair, item.common, among));
    }
    return unproven;
  }

 private:
  /// Lanes in which the joints of a map keep its groups apart all along their part.
  HWY_INLINE Mask KnownFree(const JointMap& map) const {
    const auto deviation = [&](std::size_t axis) HWY_ATTR {
      const float per_s = work_.deviation[static_cast<std::size_t>(map.joints[axis])];
      return Fill(static_cast<float>(work_.half_length) * per_s);
    };
    return checker_.KnownFree(map, deviation(0), deviation(1));
  }
  /// Lanes of `among` in which squared distances do not exceed reach + travel.
  HWY_INLINE Mask Within(Mask among, V squared, float reach, V travel) {
    const V inflated = hn::Add(Fill(reach), travel);
    const Mask near = hn::And(among, hn::Le(squared, Square(inflated)));
    if (want_clearance_) {
      Note(hn::AndNot(near, among),
           hn::Sub(hn::Sqrt(hn::Max(squared, hn::Zero(kFloats))), inflated));
    }
    return near;
  }
  /// The same for a point that moves by `step`, `e` from something convex: only steps along e
  /// count, for the plane across it keeps them apart.
  /// @param inflated  radii and what both may move beside the step.
  HWY_INLINE Mask WithinAlong(Mask among, const V3& e, V inflated, const V3& step) {
    const V squared = Dot(e, e), distance = hn::Sqrt(squared);
    const V towards = hn::Abs(Dot(e, step));
    const Mask near = hn::And(among, hn::Le(squared, hn::MulAdd(inflated, distance, towards)));
    if (want_clearance_) {
      const V beyond = hn::Sub(hn::Sub(distance, inflated), hn::Div(towards, distance));
      Note(hn::AndNot(near, among), beyond);
    }
    return near;
  }
  HWY_INLINE void Note(Mask proven, V beyond) {
    least_ = hn::IfThenElse(proven, hn::Min(least_, beyond), least_);
  }

  const BatchBody& BodyAt(int body) const { return model_.bodies[static_cast<std::size_t>(body)]; }

  HWY_INLINE Mask NearStanding(const BatchItem& item, Mask among) {
    const V3 center = checker_.placement().GroupCenter(item.group_a);
    const Travel travel = travels_.OfPoint(center, item.group_a, -1, 0);
    return WithinAlong(among, checker_.FromStanding(item, center), Fill(item.reach + travel.bend),
                       travel.step);
  }
  HWY_INLINE Mask NearMoving(const BatchItem& item, Mask among) {
    const V3 a = checker_.placement().GroupCenter(item.group_a);
    const V3 b = checker_.placement().GroupCenter(item.group_b);
    const Travel travel_a = travels_.OfPoint(a, item.group_a, item.common, 0);
    const Travel travel_b = travels_.OfPoint(b, item.group_b, item.common, 0);
    return WithinAlong(among, a - b, Fill(item.reach + travel_a.bend + travel_b.bend),
                       travel_a.step - travel_b.step);
  }

  Mask UnprovenStanding(const BatchBodyPair& pair, Mask among) {
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = checker_.placement().BodyCenter(pair.a);
    const Travel travel = travels_.OfPoint(center, body.joint, -1, body.offset);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      const float reach = body.sphere.radius + gaps_.ShapeAt(other).outer + travel.bend;
      Mask open = WithinAlong(hn::AndNot(unproven, among), gaps_.FromShape(center, other),
                              Fill(reach), gaps_.AlongAxesOf(other, travel.step));
      if (None(open)) continue;
      const V turn = travels_.TurnOf(body.joint, -1), length = travel.Length();
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        const V quick = hn::MulAdd(turn, Fill(gaps_.ShapeAt(s).span), length);
        unproven = hn::Or(unproven, UnprovenShape(s, other, -1, open, quick));
        if (touches_) return unproven;
        open = hn::AndNot(unproven, open);
        if (None(open)) break;
      }
    }
    return unproven;
  }

  Mask UnprovenMoving(const BatchBodyPair& pair, int common, Mask among) {
    const BatchBody& a = BodyAt(pair.a);
    const BatchBody& b = BodyAt(pair.b);
    const V3 center_a = checker_.placement().BodyCenter(pair.a);
    const V3 center_b = checker_.placement().BodyCenter(pair.b);
    const Travel travel_a = travels_.OfPoint(center_a, a.joint, common, a.offset);
    const Travel travel_b = travels_.OfPoint(center_b, b.joint, common, b.offset);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    const float reach = a.sphere.radius + b.sphere.radius + travel_a.bend + travel_b.bend;
    among = WithinAlong(among, center_a - center_b, Fill(reach), travel_a.step - travel_b.step);
    if (None(among)) return unproven;
    const V turn_a = travels_.TurnOf(a.joint, common), turn_b = travels_.TurnOf(b.joint, common);
    const V length_a = travel_a.Length(), length_b = travel_b.Length();
    for (int s = a.first_shape; s < a.first_shape + a.shape_count; ++s) {
      const BatchShape& shape = gaps_.ShapeAt(s);
      const V quick_a = hn::MulAdd(turn_a, Fill(shape.span), length_a);
      Mask open = Within(hn::AndNot(unproven, among), gaps_.PointTo(center_b, s),
                         shape.outer + b.sphere.radius, hn::Add(quick_a, length_b));
      for (int t = b.first_shape; t < b.first_shape + b.shape_count; ++t) {
        if (None(open)) break;
        const V quick_b = hn::MulAdd(turn_b, Fill(gaps_.ShapeAt(t).span), length_b);
        unproven = hn::Or(unproven, UnprovenShape(s, t, common, open, hn::Add(quick_a, quick_b)));
        if (touches_) return unproven;
        open = hn::AndNot(unproven, open);
      }
    }
    return unproven;
  }

  /// @param quick  bound of what both travel; the tighter one costs more.
  Mask UnprovenShape(int s, int t, int common, Mask among, V quick) {
    if (gaps_.ShapeAt(s).core > gaps_.ShapeAt(t).core) std::swap(s, t);
    const BatchShape& a = gaps_.ShapeAt(s);
    if (a.core == BatchCore::kPoint && (gaps_.HasNearestPoint(t)))
      return UnprovenPoint(s, t, common, among, quick);
    const float outer = a.outer + gaps_.ShapeAt(t).outer;
    among = Within(among, gaps_.PointTo(gaps_.Center(s), t), outer + a.circumradius, quick);
    if (None(among)) return among;
    const Gap gap = gaps_.Between(s, t, hn::Add(Fill(outer), quick));
    Judge(gap, among);
    const V squared = hn::Max(gap.squared, hn::Zero(kFloats));
    among = Within(among, squared, outer, quick);
    if (None(among)) return among;
    return Within(among, squared, outer, hn::Add(TravelOfCore(s, common), TravelOfCore(t, common)));
  }

  Mask UnprovenPoint(int s, int t, int common, Mask among, V quick) {
    const BatchShape& a = gaps_.ShapeAt(s);
    const BatchShape& b = gaps_.ShapeAt(t);
    const V3 center = gaps_.Center(s), e = gaps_.FromShape(center, t);
    const V squared = Dot(e, e);
    const float outer = a.outer + b.outer;
    among = Within(among, squared, outer, quick);
    if (None(among)) return among;
    Judge(gaps_.OfPoint(squared, s, t), among);
    const Travel of_a = OfCenter(s, common);
    if (b.joint == common) {
      return WithinAlong(among, e, Fill(outer + of_a.bend), gaps_.AlongAxesOf(t, of_a.step));
    }
    const Travel of_b = OfCenter(t, common);
    const V inflated = hn::MulAdd(travels_.TurnOf(b.joint, common), Fill(b.circumradius),
                                  Fill(outer + of_a.bend + of_b.bend));
    return WithinAlong(among, e, inflated, gaps_.AlongAxesOf(t, of_a.step - of_b.step));
  }

  void Judge(const Gap& gap, Mask among) {
    if (!None(hn::And(among, hn::Lt(gap.upper, Fill(gap.touch_below))))) touches_ = true;
    if (gap.is_vague && !None(hn::And(among, hn::Le(gap.squared, hn::Zero(kFloats))))) {
      is_hopeless_ = true;
    }
  }

  Travel OfCenter(int s, int common) {
    const BatchShape& shape = gaps_.ShapeAt(s);
    return travels_.OfPoint(gaps_.Center(s), shape.joint, common, shape.offset);
  }

  /// Most travel of the points of a core: the bound is convex, so at its ends.
  V TravelOfCore(int s, int common) {
    const BatchShape& shape = gaps_.ShapeAt(s);
    if (shape.joint == common) return hn::Zero(kFloats);
    if (shape.core == BatchCore::kSegment) {
      const V3 center = gaps_.Center(s), u = checker_.placement().HalfVectorOf(s);
      const auto end = [&](const V3& p) HWY_ATTR {
        return travels_.OfPoint(p, shape.joint, common, shape.offset).Length();
      };
      return hn::Max(end(center + u), end(center - u));
    }
    return hn::MulAdd(travels_.TurnOf(shape.joint, common), Fill(shape.circumradius),
                      OfCenter(s, common).Length());
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  BlockChecker checker_;
  Gaps& gaps_;
  Travels travels_;
  bool want_clearance_;
  bool touches_ = false;
  bool is_hopeless_ = false;  ///< Boxes around other shapes overlap.
  V least_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
