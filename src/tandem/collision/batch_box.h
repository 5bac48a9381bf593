// Boxes of configurations. Compiled once per instruction set; private to batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_BOX_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_BOX_H
#undef TANDEM_COLLISION_BATCH_BOX_H
#else
#define TANDEM_COLLISION_BATCH_BOX_H
#endif

#include "tandem/collision/batch_box_proof.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// Deviations of joints, from the columns of Scratch::D.
void LoadDeviations(const BatchPairs& pairs, BatchChecker::Scratch& work) {
  for (const int j : pairs.joints) {
    const BatchJoint& joint = work.model.joints[static_cast<std::size_t>(j)];
    LaneRow& row = work.box_deviation[static_cast<std::size_t>(j)];
    for (int lane = 0; lane < kLanes; ++lane) {
      const double D = work.D[std::min(lane, work.count - 1) * work.D_stride + joint.column];
      row.lane[lane] = kBoxRoundUp * static_cast<float>(std::abs(joint.multiplier) * D);
    }
  }
}

void ExamineBoxes(const BatchPairs& pairs, std::span<const int> items, bool want_clearance,
                  BatchChecker::Scratch& work) {
  LoadValues(pairs, work);
  LoadDeviations(pairs, work);
  BoxProver prover(pairs, want_clearance, work);
  prover.travels().Bound();
  prover.checker().placement().Place(pairs);
  BoxFindings& found = work.findings;
  std::ranges::fill(found.pair, -1);
  std::ranges::fill(found.mover, -1);
  const unsigned all = (1U << work.count) - 1;
  found.open = 0;
  const auto look = [&](int i) HWY_ATTR {
    const unsigned open = Bits(prover.Unproven(pairs.items[static_cast<std::size_t>(i)])) & all;
    if (open == 0) return false;
    found.open |= open;
    if (std::ranges::find(work.next_pending, i) == work.next_pending.end()) {
      work.next_pending.push_back(i);
    }
    return false;
  };
  if (items.empty()) {
    prover.checker().AnyItem([&](int group, float radius, V squared)
                                 HWY_ATTR { return prover.IsFar(group, radius, squared); },
                             look);
  } else {
    for (const int i : items) look(i);
  }
  found.touching = Bits(prover.touching()) & all;
  found.hopeless = Bits(prover.hopeless()) & all;
  found.blocked = Bits(prover.blocked()) & all;
  if (!want_clearance) return;
  Store(prover.least(), found.least);
  Store(prover.nearest(), found.nearest);
  Store(prover.excess(), found.excess);
}

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
