#include "tandem/collision/box_check.h"

#include "tandem/collision/batch_work.h"
#include "tandem/collision/ssv_box.h"
#include "tandem/core/contract.h"

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
    const bool is_a = own.travel(pair.a, pair.shared) >= own.travel(pair.b, pair.shared);
    result.mover = is_a ? pair.body_a : pair.body_b;
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

namespace {

/// What the kernel knows of one column.
BoxFinding finding_of(const BoxFindings& found, unsigned lane) {
  const unsigned bit = 1U << lane;
  BoxFinding result;
  if ((found.open & bit) == 0) return result;
  result.verdict = (found.blocked & bit) != 0 ? BoxVerdict::kTouching : BoxVerdict::kOpen;
  result.touches_at_center = (found.touching & bit) != 0;
  result.pair = found.pair[lane];
  result.mover = found.mover[lane];
  return result;
}

/// The pairs of bodies of these items.
std::vector<int> pairs_of(const BatchPairs& pairs, std::span<const int> items) {
  std::vector<int> selection;
  for (const int i : items) {
    const BatchItem& item = pairs.items[static_cast<std::size_t>(i)];
    for (int k = item.first; k < item.first + item.count; ++k) {
      selection.push_back(pairs.body_pairs[static_cast<std::size_t>(k)].pair);
    }
  }
  return selection;
}

}  // namespace

int boxes_at_once() { return batch_lanes(); }

void examine_boxes(const BatchChecker& checker, const Eigen::Ref<const Eigen::MatrixXd>& Q,
                   const Eigen::Ref<const Eigen::MatrixXd>& D, const BatchPairs& pairs,
                   std::span<const int> items, BatchChecker::Scratch& work,
                   std::vector<BoxFinding>& out, std::vector<int>& open) {
  expects(pairs.model == &work.model && &work.exact == &checker.exact(),
          "pairs and scratch were made by this checker");
  expects(Q.rows() == work.model.dof && D.rows() == work.model.dof && Q.cols() == D.cols(),
          "Q and D have a row per joint of the cell's arms and a column per box");
  expects(Q.cols() <= batch_lanes(), "boxes_at_once() are examined in one go");
  out.clear();
  open.clear();
  if (Q.cols() == 0) return;
  work.keep = 0;
  work.Q = Q.data();
  work.stride = Q.outerStride();
  work.D = D.data();
  work.D_stride = D.outerStride();
  work.count = static_cast<int>(Q.cols());
  work.next_pending.clear();
  work.names_pairs = true;
  examine_boxes(pairs, items, false, work);
  work.names_pairs = false;
  open.assign(work.next_pending.begin(), work.next_pending.end());
  const BoxFindings& found = work.findings;
  std::vector<int> selection, unproven;
  for (unsigned lane = 0; lane < static_cast<unsigned>(work.count); ++lane) {
    out.push_back(finding_of(found, lane));
    if ((found.open & ~found.blocked & found.hopeless & 1U << lane) == 0) continue;
    if (selection.empty()) selection = pairs_of(pairs, open);
    unproven.clear();
    out.back() = examine_box(checker.exact(), Q.col(lane), D.col(lane), selection,
                             *work.exact_scratch, unproven);
  }
}

}  // namespace tandem::collision
