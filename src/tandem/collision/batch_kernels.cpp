// The batch checker's kernels, compiled once per instruction set and chosen at run time.

#include "tandem/collision/batch_work.h"

// What has no SSE4 is rare enough to be served by the scalar fallback.
#define HWY_DISABLED_TARGETS HWY_SSSE3
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tandem/collision/batch_kernels.cpp"
#include <hwy/foreach_target.h>  // Includes this file again for each instruction set.
//
#include <hwy/highway.h>

#include "tandem/collision/batch_box.h"
#include "tandem/collision/batch_edge.h"
#include "tandem/collision/batch_near.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

int LaneCount() { return kLanes; }

EdgeFinding ExamineEdge(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work) {
  return EdgeProver(pairs, want_clearance, work).Examine();
}

void FindNear(const BatchPairs& pairs, float within, BatchChecker::Scratch& work) {
  NearFinder(pairs, within, work).Find();
}

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tandem::collision {

HWY_EXPORT(LaneCount);
HWY_EXPORT(IsBlockFree);
HWY_EXPORT(FindNear);
HWY_EXPORT(ExamineEdge);
HWY_EXPORT(ExamineBoxes);

int batch_lanes() { return HWY_DYNAMIC_DISPATCH(LaneCount)(); }

bool is_block_free(const BatchPairs& pairs, BatchChecker::Scratch& work) {
  return HWY_DYNAMIC_DISPATCH(IsBlockFree)(pairs, work);
}

void find_near(const BatchPairs& pairs, float within, BatchChecker::Scratch& work) {
  HWY_DYNAMIC_DISPATCH(FindNear)(pairs, within, work);
}

EdgeFinding examine_edge(const BatchPairs& pairs, bool want_clearance,
                         BatchChecker::Scratch& work) {
  return HWY_DYNAMIC_DISPATCH(ExamineEdge)(pairs, want_clearance, work);
}

void examine_boxes(const BatchPairs& pairs, std::span<const int> items, bool want_clearance,
                   BatchChecker::Scratch& work) {
  HWY_DYNAMIC_DISPATCH(ExamineBoxes)(pairs, items, want_clearance, work);
}

}  // namespace tandem::collision
#endif  // HWY_ONCE
