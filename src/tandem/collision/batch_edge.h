// The proof that a straight edge is free. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_EDGE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_EDGE_H
#undef TANDEM_COLLISION_BATCH_EDGE_H
#else
#define TANDEM_COLLISION_BATCH_EDGE_H
#endif

#include "tandem/collision/batch_part.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// One call: divides the edge until every part is proven.
class EdgeProver {
 public:
  EdgeProver(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work)
      : pairs_(pairs),
        work_(work),
        part_(pairs, want_clearance, work),
        checker_(part_.checker()),
        travels_(part_.travels()) {}

  EdgeFinding Examine() {
    if (!ExamineWhole()) return EdgeFinding::kNotFree;
    for (int placed = 0; !work_.parts.empty(); std::swap(work_.parts, work_.next_parts)) {
      if (part_.is_hopeless() || placed > kMostConfigurations || work_.half_length < kLeastLength) {
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
    Store(part_.least(), least);
    work_.least_clearance = *std::min_element(least.lane, least.lane + kLanes);
    return finding;
  }

  /// The first block, spread over the edge: plain checks first, for most edges that are not free
  /// show it here. @return false if the edge is not free.
  bool ExamineWhole() {
    work_.half_length = 1.0 / kLanes;
    for (int lane = 0; lane < kLanes; ++lane) {
      work_.s[lane] = (2 * lane + 1 - kLanes) * work_.half_length;
    }
    part_.Place();
    const auto last = static_cast<std::size_t>(work_.last_hit);
    if (last < pairs_.items.size() && checker_.Touches(pairs_.items[last])) return false;
    work_.pending.clear();
    const auto half_length = static_cast<float>(work_.half_length);
    const auto is_far = [&](int group, float radius, V squared) HWY_ATTR {
      return part_.IsFarApart(squared, radius + half_length * travels_.GroupTravel(group, 0));
    };
    const auto hits = [&](int i) HWY_ATTR {
      const BatchItem& item = pairs_.items[static_cast<std::size_t>(i)];
      const V squared = checker_.ItemGap(item);
      if (part_.IsFarApart(squared, item.reach + half_length * travels_.OfItem(item))) return false;
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
      part_.Place();
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
      const unsigned unproven = Bits(part_.Unproven(item)) & ((1U << count) - 1);
      if (part_.touches()) {
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

  const BatchPairs& pairs_;
  BatchChecker::Scratch& work_;
  PartProver part_;
  BlockChecker& checker_;
  const Travels& travels_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
