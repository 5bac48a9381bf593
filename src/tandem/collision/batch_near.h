// Which shapes are near each other. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_NEAR_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_NEAR_H
#undef TANDEM_COLLISION_BATCH_NEAR_H
#else
#define TANDEM_COLLISION_BATCH_NEAR_H
#endif

#include "tandem/collision/batch_check.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Pairs of shapes of one block that may be nearer than a distance, from groups down to shapes.
class NearFinder {
 public:
  NearFinder(const BatchPairs& pairs, float within, BatchChecker::Scratch& work)
      : pairs_(pairs), within_(within), work_(work), model_(work.model), checker_(pairs, work) {}

  void Find() {
    LoadValues(pairs_, work_);
    checker_.placement().Place(pairs_);
    work_.near.clear();
    const auto is_far = [&](int, float radius, V squared)
                            HWY_ATTR { return Apart(squared, radius); };
    const auto find = [&](int i) HWY_ATTR {
      FindIn(pairs_.items[static_cast<std::size_t>(i)]);
      return false;
    };
    checker_.AnyItem(is_far, find);
  }

 private:
  const BatchBody& BodyAt(int body) const { return model_.bodies[static_cast<std::size_t>(body)]; }

  HWY_INLINE Mask Near(V squared, float reach) const {
    const float most = reach + within_;
    return hn::Le(squared, Fill(most * most));
  }
  HWY_INLINE bool Apart(V squared, float reach) const { return None(Near(squared, reach)); }

  void FindIn(const BatchItem& item) {
    if (Apart(checker_.ItemGap(item), item.reach)) return;
    for (int i = item.first; i < item.first + item.count; ++i) {
      const BatchBodyPair& pair = pairs_.body_pairs[static_cast<std::size_t>(i)];
      item.group_b < 0 ? FindStanding(item, pair) : FindMoving(pair);
    }
  }

  void FindStanding(const BatchItem& item, const BatchBodyPair& pair) {
    const BatchBody& body = BodyAt(pair.a);
    const V3 center = checker_.placement().BodyCenter(pair.a);
    if (model_.group_sizes[static_cast<std::size_t>(body.joint)] > 1 &&
        Apart(checker_.StandingGap(item, center), body.sphere.radius + BodyAt(pair.b).outer)) {
      return;
    }
    Gaps& gaps = checker_.gaps();
    for (int i = pair.first_shape; i < pair.first_shape + pair.shape_count; ++i) {
      const int other = pairs_.standing_shapes[static_cast<std::size_t>(i)];
      if (Apart(gaps.PointTo(center, other), body.sphere.radius + gaps.ShapeAt(other).outer)) {
        continue;
      }
      for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
        Add(pair.pair, s, other);
      }
    }
  }

  void FindMoving(const BatchBodyPair& pair) {
    const BatchBody& a = BodyAt(pair.a);
    const BatchBody& b = BodyAt(pair.b);
    const V3 center_b = checker_.placement().BodyCenter(pair.b);
    const V3 r = checker_.placement().BodyCenter(pair.a) - center_b;
    if (Apart(Dot(r, r), a.sphere.radius + b.sphere.radius)) return;
    Gaps& gaps = checker_.gaps();
    for (int s = a.first_shape; s < a.first_shape + a.shape_count; ++s) {
      if (Apart(gaps.PointTo(center_b, s), b.sphere.radius + gaps.ShapeAt(s).outer)) continue;
      for (int t = b.first_shape; t < b.first_shape + b.shape_count; ++t) Add(pair.pair, s, t);
    }
  }

  HWY_INLINE void Add(int pair, int a, int b) {
    Gaps& gaps = checker_.gaps();
    const BatchShape& shape_a = gaps.ShapeAt(a);
    const float outer = shape_a.outer + gaps.ShapeAt(b).outer;
    if (Apart(gaps.PointTo(gaps.Center(a), b), outer + shape_a.circumradius)) return;
    const V squared = gaps.Between(a, b, Fill(outer + within_)).squared;
    const unsigned lanes = Bits(Near(squared, outer)) & ((1U << work_.count) - 1);
    if (lanes == 0) return;
    NearLanes& near = work_.near.emplace_back(NearLanes{pair, a, b, lanes, {}, outer});
    Store(squared, near.squared);
  }

  const BatchPairs& pairs_;
  float within_;
  BatchChecker::Scratch& work_;
  const BatchModel& model_;
  BlockChecker checker_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
