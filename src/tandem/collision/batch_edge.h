// The proof that a straight edge is free. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_EDGE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_EDGE_H
#undef TANDEM_COLLISION_BATCH_EDGE_H
#else
#define TANDEM_COLLISION_BATCH_EDGE_H
#endif

#include "tandem/collision/batch_check.h"
#include "tandem/collision/batch_travel.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// One call. Lanes are middles of parts of the edge, all of one length; what is further apart at
/// the middle than it can move within the part is done with.
/// Ref: docs/methods.md, "Continuous-time certificate".
class EdgeProver {
 public:
  EdgeProver(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work)
      : pairs_(pairs),
        work_(work),
        model_(work.model),
        checker_(pairs, work),
        travels_(pairs, work, checker_.placement()),
        want_clearance_(want_clearance),
        least_(Fill(static_cast<float>(BatchChecker::kClearanceCap))) {}

  EdgeFinding Examine() {
    travels_.Bound();
    if (!ExamineWhole()) return EdgeFinding::kNotFree;
    for (int placed = 0; !work_.parts.empty(); std::swap(work_.parts, work_.next_parts)) {
      if (is_hopeless_ || placed > kMostConfigurations || work_.half_length < kLeastLength) {
        return Found(EdgeFinding::kOpen);
      }
      placed += Divide();
      if (!ExamineParts()) return EdgeFinding::kNotFree;
    }
    return Found(EdgeFinding::kFree);
  }

 private:
  /// Then the exact certificate takes over: it bounds motion along the normal, so that it needs
  /// fewer parts where things pass close by.
  static constexpr int kMostConfigurations = 192;
  static constexpr double kLeastLength = 1e-5;  ///< [-] of the edge.

  EdgeFinding Found(EdgeFinding finding) {
    LaneRow least{};
    Store(least_, least);
    work_.least_clearance = *std::min_element(least.lane, least.lane + kLanes);
    return finding;
  }

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
  }

  /// The first block, spread over the edge: plain checks first, for most edges that are not free
  /// show it here. @return false if the edge is not free.
  bool ExamineWhole() {
    work_.half_length = 1.0 / kLanes;
    for (int lane = 0; lane < kLanes; ++lane) {
      work_.s[lane] = (2 * lane + 1 - kLanes) * work_.half_length;
    }
    Place();
    const auto last = static_cast<std::size_t>(work_.last_hit);
    if (last < pairs_.items.size() && checker_.Touches(pairs_.items[last])) return false;
    work_.pending.clear();
    const auto half_length = static_cast<float>(work_.half_length);
    const auto is_far = [&](int group, float radius, V squared) HWY_ATTR {
      return IsFarApart(squared, radius + half_length * travels_.GroupTravel(group, 0));
    };
    const auto hits = [&](int i) HWY_ATTR {
      const BatchItem& item = pairs_.items[static_cast<std::size_t>(i)];
      const V squared = checker_.ItemGap(item);
      if (IsFarApart(squared, item.reach + half_length * travels_.OfItem(item))) return false;
      work_.pending.push_back(i);
      const bool apart = All(hn::Gt(squared, Fill(item.reach * item.reach)));
      if (apart || !checker_.Descend(item)) return false;
      work_.last_hit = i;
      return true;
    };
    if (checker_.AnyItem(is_far, hits)) return false;
    work_.next_pending.clear();
    work_.next_parts.clear();
    if (!ExaminePending(kLanes)) return false;
    std::swap(work_.parts, work_.next_parts);
    std::swap(work_.pending, work_.next_pending);
    return true;
  }

  HWY_INLINE bool IsFarApart(V squared, float inflated) {
    if (!All(hn::Gt(squared, Fill(inflated * inflated)))) return false;
    if (want_clearance_) least_ = hn::Min(least_, hn::Sub(hn::Sqrt(squared), Fill(inflated)));
    return true;
  }

  /// Halves the parts, or more where that fills a block. @return their number.
  int Divide() {
    const auto count = static_cast<int>(work_.parts.size());
    const int pieces = std::max(2, kLanes / count);
    const double length = work_.half_length / pieces;
    work_.next_parts.clear();
    for (const EdgePart& part : work_.parts) {
      for (int i = 0; i < pieces; ++i) {
        work_.next_parts.push_back({part.middle + (2 * i + 1 - pieces) * length});
      }
    }
    work_.half_length = length;
    std::swap(work_.parts, work_.next_parts);
    return count * pieces;
  }

  /// @return false if the edge is not free; else next_parts and pending are what is left.
  bool ExamineParts() {
    work_.next_parts.clear();
    work_.next_pending.clear();
    const auto size = static_cast<int>(work_.parts.size());
    for (int first = 0; first < size; first += kLanes) {
      const int count = std::min(kLanes, size - first);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int part = first + std::min(lane, count - 1);
        work_.s[lane] = work_.parts[static_cast<std::size_t>(part)].middle;
      }
      Place();
      if (!ExaminePending(count)) return false;
    }
    std::swap(work_.pending, work_.next_pending);
    return true;
  }

  /// Adds to next_parts and next_pending what is not proven in the first `count` lanes as placed.
  bool ExaminePending(int count) {
    unsigned open = 0;
    for (const int i : work_.pending) {
      const BatchItem& item = pairs_.items[static_cast<std::size_t>(i)];
      touches_ = false;
      const unsigned unproven = Bits(Unproven(item)) & ((1U << count) - 1);
      if (touches_) {
        work_.last_hit = i;
        return false;
      }
      if (unproven == 0) continue;
      open |= unproven;
      if (std::ranges::find(work_.next_pending, i) == work_.next_pending.end()) {
        work_.next_pending.push_back(i);
      }
    }
    for (; open != 0; open &= open - 1) {
      work_.next_parts.push_back({work_.s[std::countr_zero(open)]});
    }
    return true;
  }

  /// Lanes of `among` in which squared distances do not exceed reach + travel.
  HWY_INLINE Mask Within(Mask among, V squared, float reach, V travel) {
    const V inflated = hn::Add(Fill(reach), travel);
    const Mask near = hn::And(among, hn::Le(squared, Square(inflated)));
    if (want_clearance_) {
      const V beyond = hn::Sub(hn::Sqrt(hn::Max(squared, hn::Zero(kFloats))), inflated);
      const Mask proven = hn::AndNot(near, among);
      least_ = hn::IfThenElse(proven, hn::Min(least_, beyond), least_);
    }
    return near;
  }

  /// Lanes in which the item is not proven apart all along its part; sets touches_.
  HWY_NOINLINE Mask Unproven(const BatchItem& item) {
    const V squared = checker_.ItemGap(item);
    Placement& placement = checker_.placement();
    V travel = Fill(static_cast<float>(work_.half_length) * travels_.OfItem(item));
    Mask open = Within(hn::Eq(travel, travel), squared, item.reach, travel);
    if (None(open)) return open;
    const V travel_a =
        travels_.OfPoint(placement.GroupCenter(item.group_a), item.group_a, item.common);
    const V travel_b = item.group_b < 0 ? hn::Zero(kFloats)
                                        : travels_.OfPoint(placement.GroupCenter(item.group_b),
                                                           item.group_b, item.common);
    open = Within(open, squared, item.reach, hn::Add(travel_a, travel_b));
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = item.first; i < item.first + item.count && !touches_; ++i) {
      const BatchBodyPair& pair = pairs_.body_pairs[static_cast<std::size_t>(i)];
      // A lane that is left to its parts anyway is not looked at further.
      const Mask among = hn::AndNot(unproven, open);
      if (None(among)) break;
      unproven = hn::Or(unproven, item.group_b < 0 ? UnprovenStanding(pair, among, travel_a)
                                                   : UnprovenMoving(pair, item.common, among,
                                                                    travel_a, travel_b));
    }
    return unproven;
  }

  const BatchBody& BodyAt(int body) const { return model_.bodies[static_cast<std::size_t>(body)]; }

  /// Travel of a body's centre; that of its group's where they are the same.
  HWY_INLINE V BodyTravel(const BatchBody& body, const V3& center, int common, V of_group) {
    if (model_.group_sizes[static_cast<std::size_t>(body.joint)] == 1) return of_group;
    return travels_.OfPoint(center, body.joint, common);
  }
  /// A quick bound for all points of a shape's core, from that of its body's centre.
  HWY_INLINE V QuickTravel(const BatchShape& shape, int common, V of_body) {
    return hn::Add(of_body, Fill(travels_.TurnOf(shape.joint, common) * shape.span));
  }

  Mask UnprovenStanding(const BatchBodyPair& pair, Mask among, V of_group) {
    Gaps& gaps = checker_.gaps();
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = checker_.placement().BodyCenter(pair.a);
    const V travel = BodyTravel(body, center, -1, of_group);
    Mask unproven = hn::MaskFromVec(hn::Zero(kFloats));
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      Mask open = Within(hn::AndNot(unproven, among), gaps.PointTo(center, other),
                         body.sphere.radius + gaps.ShapeAt(other).outer, travel);
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        if (None(open)) break;
        const V quick = QuickTravel(gaps.ShapeAt(s), -1, travel);
        unproven = hn::Or(unproven, UnprovenShape(s, other, -1, open, quick));
        if (touches_) return unproven;
        open = hn::AndNot(unproven, open);
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
      Mask open = Within(hn::AndNot(unproven, among), gaps.PointTo(center_b, s),
                         shape.outer + b.sphere.radius, hn::Add(quick_a, travel_b));
      for (int t = b.first_shape; t < b.first_shape + b.shape_count; ++t) {
        if (None(open)) break;
        const V quick = hn::Add(quick_a, QuickTravel(gaps.ShapeAt(t), common, travel_b));
        unproven = hn::Or(unproven, UnprovenShape(s, t, common, open, quick));
        if (touches_) return unproven;
        open = hn::AndNot(unproven, open);
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
    const Gap gap = gaps.Between(s, t);
    if (!None(hn::And(among, hn::Lt(gap.squared, Fill(gap.touch_below))))) touches_ = true;
    const V squared = hn::Max(gap.squared, hn::Zero(kFloats));
    if (gap.is_box && !None(hn::And(among, hn::Le(squared, hn::Zero(kFloats)))))
      is_hopeless_ = true;
    among = Within(among, squared, outer, quick);
    if (None(among)) return among;
    return Within(among, squared, outer,
                  hn::Add(travels_.OfShape(s, common), travels_.OfShape(t, common)));
  }

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  BlockChecker checker_;
  Travels travels_;
  bool want_clearance_;
  bool touches_ = false;
  bool is_hopeless_ = false;  ///< Boxes around other shapes overlap: no division parts them.
  V least_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
