#include "tandem/collision/box_check.h"

#include "tandem/collision/ssv_box.h"

namespace tandem::collision {

using Finding = PairOnBox::Finding;

namespace {

/// Of one pair. A box in which nothing touches is free if at one of its configurations nothing is
/// inside a closed mesh.
Finding find(SsvScratch& scratch, const SsvPair& pair) {
  const Finding finding = examine_on_box(scratch, pair, 0.0, 0.0).finding;
  return pair.solid && is_inside(scratch, pair) ? Finding::kTouching : finding;
}

}  // namespace

BoxFinding examine_box(const SsvChecker& checker, const Eigen::Ref<const Eigen::VectorXd>& center,
                       const Eigen::Ref<const Eigen::VectorXd>& D, std::span<const int> pairs,
                       CollisionChecker::Scratch& scratch, std::vector<int>& unproven) {
  SsvScratch& own = own_scratch(checker.model(), scratch);
  own.place(center);
  own.set_deviation(D);
  const std::size_t first = unproven.size();
  BoxFinding result;
  const auto note = [&](int index, const SsvPair& pair) {
    result.pair = index;
    result.travel_a = own.travel(pair.a, pair.shared);
    result.travel_b = own.travel(pair.b, pair.shared);
  };
  for (const int index : pairs) {
    const SsvPair& pair = own.model().pair(index);
    const Finding finding = find(own, pair);
    if (finding == Finding::kApart) continue;
    if (finding == Finding::kTouching && touches_on_box(own, pair)) {
      unproven.resize(first);
      note(index, pair);
      result.verdict = BoxVerdict::kTouching;
      result.touches_at_center = true;
      return result;
    }
    unproven.push_back(index);
    const bool leads = finding == Finding::kTouching && !result.touches_at_center;
    if (result.verdict == BoxVerdict::kFree || leads) {
      note(index, pair);
      std::swap(unproven[first], unproven.back());
    }
    result.verdict = BoxVerdict::kOpen;
    result.touches_at_center |= leads;
  }
  return result;
}

}  // namespace tandem::collision
