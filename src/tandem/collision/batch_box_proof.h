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
        names_pairs_(work.names_pairs),
        touching_(hn::MaskFromVec(hn::Zero(kFloats))),
        hopeless_(touching_),
        blocked_(touching_),
        least_(Fill(static_cast<float>(BatchChecker::kClearanceCap))),
        nearest_(least_),
        excess_(hn::Zero(kFloats)),
        furthest_(Fill(-1)) {}

  BlockChecker& checker() { return checker_; }
  BoxTravels& travels() { return travels_; }

  Mask touching() const { return touching_; }  ///< Lanes in which something touches as placed.
  Mask hopeless() const { return hopeless_; }  ///< Boxes around other shapes overlap.
  Mask blocked() const { return blocked_; }    ///< Two shapes touch in all of the box.
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
    const V travel_a = travels_.OfGroupCenter(item.group_a, item.common);
    const V travel_b =
        item.group_b < 0 ? hn::Zero(kFloats) : travels_.OfGroupCenter(item.group_b, item.common);
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
  HWY_INLINE V BodyTravel(int body, int common, V of_group) {
    const auto joint = static_cast<std::size_t>(BodyAt(body).joint);
    return model_.group_sizes[joint] == 1 ? of_group : travels_.OfBodyCenter(body, common);
  }
  /// A quick bound for all points of a shape's core, from that of its body's centre.
  HWY_INLINE V QuickTravel(const BatchShape& shape, int common, V of_body) {
    return hn::MulAdd(travels_.TurnOf(shape.joint, common), Fill(shape.span), of_body);
  }

  Mask UnprovenStanding(const BatchBodyPair& pair, Mask among, V of_group) {
    Gaps& gaps = checker_.gaps();
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = checker_.placement().BodyCenter(pair.a);
    const V travel = BodyTravel(pair.a, -1, of_group);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      Mask open = Within(Rest(among), gaps.PointTo(center, other),
                         body.sphere.radius + gaps.ShapeAt(other).outer, travel);
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        if (None(open)) break;
        const V quick = QuickTravel(gaps.ShapeAt(s), -1, travel);
        unproven = hn::Or(unproven, UnprovenShape(pair, s, other, -1, open, quick));
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
    const V travel_a = BodyTravel(pair.a, common, of_group_a);
    const V travel_b = BodyTravel(pair.b, common, of_group_b);
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
        unproven = hn::Or(unproven, UnprovenShape(pair, s, t, common, open, quick));
        open = Rest(open);
      }
    }
    return unproven;
  }

  /// @param quick  bound of what both travel; the tighter one costs more.
  Mask UnprovenShape(const BatchBodyPair& pair, int s, int t, int common, Mask among, V quick) {
    Gaps& gaps = checker_.gaps();
    const BatchShape& a = gaps.ShapeAt(s);
    const float outer = a.outer + gaps.ShapeAt(t).outer;
    among = Within(among, gaps.PointTo(gaps.Center(s), t), outer + a.circumradius, quick);
    if (None(among)) return among;
    const Gap gap = gaps.Between(s, t, hn::Add(Fill(outer + work_.keep), quick));
    const Mask touches = hn::And(among, hn::Lt(gap.upper, Fill(gap.touch_below)));
    if (names_pairs_ && !None(touches)) NoteTouching(pair, s, t, common, touches, gap.upper);
    touching_ = hn::Or(touching_, touches);
    const V squared = hn::Max(gap.squared, hn::Zero(kFloats));
    if (gap.is_vague) {
      hopeless_ = hn::Or(hopeless_, hn::And(among, hn::Le(squared, hn::Zero(kFloats))));
    } else if (want_clearance_) {
      NoteNearest(among, squared, outer);
    }
    among = Within(among, squared, outer, quick);
    if (None(among)) return among;
    const V travel_a = travels_.OfShape(s, common), travel_b = travels_.OfShape(t, common);
    const V travel = hn::Add(travel_a, travel_b);
    among = Within(among, squared, outer, travel);
    if (None(among)) return among;
    if (want_clearance_) NoteExcess(among, squared, outer, travel);
    if (names_pairs_) NoteOpen(pair, among, squared, outer, travel_a, travel_b);
    return among;
  }

  /// A signed distance of convex shapes is the largest gap between supporting planes: so it changes
  /// by no more than their points move.
  HWY_NOINLINE void NoteTouching(const BatchBodyPair& pair, int s, int t, int common, Mask touches,
                                 V squared) {
    const Gaps& gaps = checker_.gaps();
    const V travel_a = travels_.OfShape(s, common), travel_b = travels_.OfShape(t, common);
    const V apart = hn::CopySign(hn::Sqrt(hn::Abs(squared)), squared);
    const float inner = gaps.ShapeAt(s).inner + gaps.ShapeAt(t).inner;
    const Mask blocks =
        hn::And(touches, hn::Lt(hn::Add(apart, hn::Add(travel_a, travel_b)), Fill(inner)));
    Name(pair, hn::AndNot(touching_, touches), travel_a, travel_b);
    Name(pair, hn::AndNot(blocked_, blocks), travel_a, travel_b);
    blocked_ = hn::Or(blocked_, blocks);
  }
  void NoteOpen(const BatchBodyPair& pair, Mask open, V squared, float reach, V travel_a,
                V travel_b) {
    const V room = hn::Max(hn::Sub(hn::Sqrt(squared), Fill(reach)), Fill(1e-9F));
    const V excess = hn::Div(hn::Add(travel_a, travel_b), room);
    const Mask further = hn::AndNot(touching_, hn::And(open, hn::Gt(excess, furthest_)));
    furthest_ = hn::IfThenElse(further, excess, furthest_);
    Name(pair, further, travel_a, travel_b);
  }
  void Name(const BatchBodyPair& pair, Mask lanes, V travel_a, V travel_b) {
    const unsigned by_b = Bits(hn::Lt(travel_a, travel_b));
    for (unsigned bits = Bits(lanes); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      work_.findings.pair[lane] = pair.pair;
      work_.findings.mover[lane] = (by_b >> lane & 1U) != 0 ? pair.b : pair.a;
    }
  }

  /// A lane that is unproven is still searched for what touches, or blocks, but not one that does.
  HWY_INLINE Mask Rest(Mask among) const {
    return hn::AndNot(names_pairs_ ? blocked_ : touching_, among);
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  BlockChecker checker_;
  BoxTravels travels_;
  bool want_clearance_, names_pairs_;
  Mask touching_, hopeless_, blocked_;
  V least_, nearest_, excess_;
  V furthest_;  // From a proof, of the pairs that are named.
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
