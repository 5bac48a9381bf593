// The proof that nothing touches while joints deviate from placed configurations. Compiled once per
// instruction set; private to batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_BOX_PROOF_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_BOX_PROOF_H
#undef TANDEM_COLLISION_BATCH_BOX_PROOF_H
#else
#define TANDEM_COLLISION_BATCH_BOX_PROOF_H
#endif

#include "tandem/collision/batch_box_travel.h"
#include "tandem/collision/batch_check.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// One block of configurations: what is further apart than it can move is done with.
/// Ref: docs/methods.md, "Continuous-time certificate".
class BoxProver {
 public:
  BoxProver(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work)
      : pairs_(pairs),
        work_(work),
        model_(work.model),
        checker_(pairs, work),
        travels_(pairs, work, checker_.placement()),
        want_clearance_(want_clearance),
        touching_(hn::MaskFromVec(hn::Zero(kFloats))),
        hopeless_(touching_),
        least_(Fill(static_cast<float>(BatchChecker::kClearanceCap))),
        nearest_(least_),
        excess_(hn::Zero(kFloats)) {}

  BlockChecker& checker() { return checker_; }
  BoxTravels& travels() { return travels_; }

  Mask touching() const { return touching_; }  ///< Lanes in which something touches as placed.
  Mask hopeless() const { return hopeless_; }  ///< Boxes around other shapes overlap.
  // If a clearance is wanted: what is kept where it is proven [m], the least distance of shapes
  // that was looked at [m], and how many times too far things move where it is not proven.
  V least() const { return least_; }
  V nearest() const { return nearest_; }
  V excess() const { return excess_; }

  /// Whether a group keeps away from a box in all lanes.
  HWY_INLINE bool IsFar(int group, float radius, V squared) {
    const V travel = travels_.OfGroup(group, 0);
    const V inflated = hn::Add(Fill(radius + work_.keep), travel);
    if (!All(hn::Gt(squared, Square(inflated)))) return false;
    if (want_clearance_) NoteBeyond(hn::Eq(squared, squared), squared, radius, travel);
    return true;
  }
  /// Lanes in which the item may come nearer than Scratch::keep, by spheres around its groups.
  HWY_INLINE Mask Near(const BatchItem& item, V squared) {
    return Within(hn::Eq(squared, squared), squared, item.reach, travels_.OfItem(item));
  }
  /// The same as far as can be told. Lanes in which something touches may be missing.
  HWY_INLINE Mask Unproven(const BatchItem& item) {
    const V squared = checker_.ItemGap(item);
    const Mask near = Near(item, squared);
    return None(near) ? near : Descend(item, squared, near);
  }

  /// The same, of the lanes in `open`.
  HWY_NOINLINE Mask Descend(const BatchItem& item, V squared, Mask open) {
    Placement& placement = checker_.placement();
    const V travel_a =
        travels_.OfPoint(placement.GroupCenter(item.group_a), item.group_a, item.common);
    const V travel_b = item.group_b < 0 ? hn::Zero(kFloats)
                                        : travels_.OfPoint(placement.GroupCenter(item.group_b),
                                                           item.group_b, item.common);
    open = Within(open, squared, item.reach, hn::Add(travel_a, travel_b));
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = item.first; i < item.first + item.count; ++i) {
      const BatchBodyPair& pair = pairs_.body_pairs[static_cast<std::size_t>(i)];
      const Mask among = Rest(open);
      if (None(among)) break;
      unproven = hn::Or(unproven, item.group_b < 0 ? UnprovenStanding(pair, among, travel_a)
                                                   : UnprovenMoving(pair, item.common, among,
                                                                    travel_a, travel_b));
    }
    return unproven;
  }

 private:
  /// Lanes of `among` in which squared distances do not exceed reach, travel and what is to be
  /// kept.
  HWY_INLINE Mask Within(Mask among, V squared, float reach, V travel) {
    const V inflated = hn::Add(Fill(reach + work_.keep), travel);
    const Mask near = hn::And(among, hn::Le(squared, Square(inflated)));
    if (want_clearance_) NoteBeyond(hn::AndNot(near, among), squared, reach, travel);
    return near;
  }
  /// The clearance that is kept in lanes proven by this.
  HWY_INLINE void NoteBeyond(Mask proven, V squared, float reach, V travel) {
    const V apart = hn::Sqrt(hn::Max(squared, hn::Zero(kFloats)));
    const V beyond = hn::Sub(apart, hn::Add(Fill(reach), travel));
    least_ = hn::IfThenElse(proven, hn::Min(least_, beyond), least_);
  }
  HWY_INLINE void NoteNearest(Mask among, V squared, float reach) {
    const V apart = hn::Sub(hn::Sqrt(squared), Fill(reach));
    nearest_ = hn::IfThenElse(among, hn::Min(nearest_, apart), nearest_);
  }
  HWY_INLINE void NoteExcess(Mask open, V squared, float reach, V travel) {
    const V room = hn::Sub(hn::Sqrt(squared), Fill(reach + work_.keep));
    const V excess = hn::Div(travel, hn::Max(room, Fill(1e-9F)));
    excess_ = hn::IfThenElse(open, hn::Max(excess_, excess), excess_);
  }

  const BatchBody& BodyAt(int body) const { return model_.bodies[static_cast<std::size_t>(body)]; }

  /// Travel of a body's centre; that of its group's where they are the same.
  HWY_INLINE V BodyTravel(const BatchBody& body, const V3& center, int common, V of_group) {
    if (model_.group_sizes[static_cast<std::size_t>(body.joint)] == 1) return of_group;
    return travels_.OfPoint(center, body.joint, common);
  }
  /// A quick bound for all points of a shape's core, from that of its body's centre.
  HWY_INLINE V QuickTravel(const BatchShape& shape, int common, V of_body) {
    return hn::MulAdd(travels_.TurnOf(shape.joint, common), Fill(shape.span), of_body);
  }

  Mask UnprovenStanding(const BatchBodyPair& pair, Mask among, V of_group) {
    Gaps& gaps = checker_.gaps();
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = checker_.placement().BodyCenter(pair.a);
    const V travel = BodyTravel(body, center, -1, of_group);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      Mask open = Within(Rest(among), gaps.PointTo(center, other),
                         body.sphere.radius + gaps.ShapeAt(other).outer, travel);
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        if (None(open)) break;
        const V quick = QuickTravel(gaps.ShapeAt(s), -1, travel);
        unproven = hn::Or(unproven, UnprovenShape(s, other, -1, open, quick));
        open = Rest(open);
      }
    }
    return unproven;
  }

  Mask UnprovenMoving(const BatchBodyPair& pair, int common, Mask among, V of_group_a,
                      V of_group_b) {
    Gaps& gaps = checker_.gaps();
    const BatchBody& a = BodyAt(pair.a);
    const BatchBody& b = BodyAt(pair.b);
    const V3 center_a = checker_.placement().BodyCenter(pair.a);
    const V3 center_b = checker_.placement().BodyCenter(pair.b);
    const V travel_a = BodyTravel(a, center_a, common, of_group_a);
    const V travel_b = BodyTravel(b, center_b, common, of_group_b);
    const V3 r = center_a - center_b;
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    among =
        Within(among, Dot(r, r), a.sphere.radius + b.sphere.radius, hn::Add(travel_a, travel_b));
    if (None(among)) return unproven;
    for (int s = a.first_shape; s < a.first_shape + a.shape_count; ++s) {
      const BatchShape& shape = gaps.ShapeAt(s);
      const V quick_a = QuickTravel(shape, common, travel_a);
      Mask open = Within(Rest(among), gaps.PointTo(center_b, s), shape.outer + b.sphere.radius,
                         hn::Add(quick_a, travel_b));
      for (int t = b.first_shape; t < b.first_shape + b.shape_count; ++t) {
        if (None(open)) break;
        const V quick = hn::Add(quick_a, QuickTravel(gaps.ShapeAt(t), common, travel_b));
        unproven = hn::Or(unproven, UnprovenShape(s, t, common, open, quick));
        open = Rest(open);
      }
    }
    return unproven;
  }

  /// @param quick  bound of what both travel; the tighter one costs more.
  Mask UnprovenShape(int s, int t, int common, Mask among, V quick) {
    Gaps& gaps = checker_.gaps();
    const BatchShape& a = gaps.ShapeAt(s);
    const float outer = a.outer + gaps.ShapeAt(t).outer;
    among = Within(among, gaps.PointTo(gaps.Center(s), t), outer + a.circumradius, quick);
    if (None(among)) return among;
    const Gap gap = gaps.Between(s, t, hn::Add(Fill(outer + work_.keep), quick));
    touching_ = hn::Or(touching_, hn::And(among, hn::Lt(gap.upper, Fill(gap.touch_below))));
    const V squared = hn::Max(gap.squared, hn::Zero(kFloats));
    if (gap.is_vague) {
      hopeless_ = hn::Or(hopeless_, hn::And(among, hn::Le(squared, hn::Zero(kFloats))));
    } else if (want_clearance_) {
      NoteNearest(among, squared, outer);
    }
    among = Within(among, squared, outer, quick);
    if (None(among)) return among;
    const V travel = hn::Add(travels_.OfShape(s, common), travels_.OfShape(t, common));
    among = Within(among, squared, outer, travel);
    if (want_clearance_ && !None(among)) NoteExcess(among, squared, outer, travel);
    return among;
  }

  /// A lane that is unproven is still searched for what touches, but not one that does touch.
  HWY_INLINE Mask Rest(Mask among) const { return hn::AndNot(touching_, among); }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  BlockChecker checker_;
  BoxTravels travels_;
  bool want_clearance_;
  Mask touching_, hopeless_;
  V least_, nearest_, excess_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
