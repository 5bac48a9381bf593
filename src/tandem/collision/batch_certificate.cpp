#include "tandem/collision/batch_certificate.h"

#include <algorithm>
#include <cmath>

#include "tandem/collision/batch_work.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

constexpr double kCap = BatchChecker::kClearanceCap;
/// Of the intervals that work begins with: so much may all joints together deviate [rad or m].
constexpr double kFirstDeviation = 0.3;
constexpr int kMostFirst = 32;  ///< Intervals of one part that work begins with.
constexpr int kMostPieces = 8;  ///< That an interval is divided into at once.
/// After so many intervals, or where they have to become so many times shorter, the exact
/// certificate takes over: it bounds motion along the normal, so that it needs fewer.
constexpr long kMostIntervals = 4096;
constexpr float kMostExcess = 1024;

/// One call of certify_parts().
class PartsCertifier {
 public:
  PartsCertifier(const BatchChecker& checker, const BatchPairs& pairs, const motion::Motion& motion,
                 BatchChecker::Scratch& work, const CertificateOptions& options,
                 const StopCondition& stop)
      : checker_(checker),
        pairs_(pairs),
        motion_(motion),
        work_(work),
        options_(options),
        stop_(stop),
        lanes_(static_cast<std::size_t>(batch_lanes())),
        Q_(motion.dof(), batch_lanes()),
        D_(motion.dof(), batch_lanes()),
        is_left_(pairs.items.size(), false) {}

  std::vector<Certificate> run(std::span<const double> times);

 private:
  struct Interval {
    double t0, t1;
    int part;
    double middle() const { return 0.5 * (t0 + t1); }
  };

  Certificate& part_of(const Interval& interval) {
    return parts_[static_cast<std::size_t>(interval.part)];
  }
  /// How much clearance is worth proving, by what has been sampled so far [m].
  double keep() const { return options_.clearance_ratio * std::max(0.0, least_sampled_); }
  void begin(std::span<const double> times);
  static void divide(const Interval& interval, int pieces, std::vector<Interval>& into);
  void examine(std::span<const Interval> block);
  void settle(const Interval& interval, std::size_t lane);
  void fail(const Interval& interval, std::size_t lane);
  void leave(const Interval& interval);
  void prove_left();
  void stopped();

  const BatchChecker& checker_;
  const BatchPairs& pairs_;
  const motion::Motion& motion_;
  BatchChecker::Scratch& work_;
  const CertificateOptions& options_;
  const StopCondition& stop_;
  const std::size_t lanes_;
  Eigen::MatrixXd Q_, D_;
  std::vector<int> items_;                  // To be asked about; all, while it is empty.
  std::vector<Interval> intervals_, next_;  // Of one division, in order of time.
  std::vector<Interval> left_;              // To the exact certificate, about
  std::vector<bool> is_left_;               // these items.
  std::vector<Certificate> parts_;
  double least_sampled_ = kCap;
  long placed_ = 0;
};

void PartsCertifier::divide(const Interval& interval, int pieces, std::vector<Interval>& into) {
  const double length = (interval.t1 - interval.t0) / pieces;
  double begin = interval.t0;
  for (int i = 1; i <= pieces; ++i) {
    const double end = i == pieces ? interval.t1 : interval.t0 + i * length;
    into.push_back({begin, end, interval.part});
    begin = end;
  }
}

void PartsCertifier::begin(std::span<const double> times) {
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    motion_.deviation(times[i], times[i + 1], D_.col(0));
    const double pieces = std::ceil(D_.col(0).sum() / kFirstDeviation);
    divide({times[i], times[i + 1], static_cast<int>(i)},
           static_cast<int>(std::clamp(pieces, 1.0, static_cast<double>(kMostFirst))), intervals_);
    Certificate part;
    part.verdict = Verdict::kFree;
    part.least_clearance = kCap;
    part.time = 0.5 * (times[i] + times[i + 1]);
    parts_.push_back(part);
  }
}

/// Something touches in the middle, as single precision is sure.
void PartsCertifier::fail(const Interval& interval, std::size_t lane) {
  world::PairSelection selection;
  for (const BatchBodyPair& pair : pairs_.body_pairs) selection.push_back(pair.pair);
  const PairClearance nearest = checker_.exact().least_clearance(
      Q_.col(static_cast<Eigen::Index>(lane)), selection, *work_.exact_scratch);
  Certificate& part = part_of(interval);
  part.verdict = Verdict::kCollision;
  part.time = interval.middle();
  part.pair = nearest.pair;
  part.depth = std::max(0.0, -nearest.distance);
}

void PartsCertifier::leave(const Interval& interval) {
  left_.push_back(interval);
  for (const int i : work_.next_pending) is_left_[static_cast<std::size_t>(i)] = true;
}

void PartsCertifier::settle(const Interval& interval, std::size_t lane) {
  Certificate& part = part_of(interval);
  ++part.evaluations;
  const BoxFindings& found = work_.findings;
  const unsigned bit = 1U << lane;
  if (!part.is_free()) return;
  if ((found.touching & bit) != 0) return fail(interval, lane);
  // Where it is open too: its pieces are asked only about what is.
  if (const auto least = static_cast<double>(found.least.lane[lane]);
      least < part.least_clearance) {
    part.least_clearance = least;
    part.time = interval.middle();
  }
  if ((found.open & bit) == 0) return;
  // What was asked to keep more than has to be kept by now says nothing about how long it may be.
  const bool stale = work_.keep > 1.001F * static_cast<float>(keep());
  const float excess = stale ? 1 : found.excess.lane[lane];
  const bool smallest =
      !(D_.col(static_cast<Eigen::Index>(lane)).maxCoeff() > options_.smallest_deviation);
  if ((found.hopeless & bit) != 0 || smallest || excess > kMostExcess || placed_ > kMostIntervals) {
    return leave(interval);
  }
  divide(interval, std::clamp(static_cast<int>(std::ceil(1.1F * excess)), 2, kMostPieces), next_);
}

void PartsCertifier::examine(std::span<const Interval> block) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    motion_.position(block[i].middle(), Q_.col(column));
    motion_.deviation(block[i].t0, block[i].t1, D_.col(column));
  }
  work_.Q = Q_.data();
  work_.D = D_.data();
  work_.stride = work_.D_stride = Q_.rows();
  work_.count = static_cast<int>(block.size());
  work_.keep = static_cast<float>(keep());
  examine_boxes(pairs_, items_, true, work_);
  placed_ += work_.count;
  for (std::size_t i = 0; i < block.size(); ++i) {
    least_sampled_ = std::min(least_sampled_, static_cast<double>(work_.findings.nearest.lane[i]));
  }
  for (std::size_t i = 0; i < block.size(); ++i) settle(block[i], i);
}

/// Asks the exact certificate, neighbours together.
void PartsCertifier::prove_left() {
  world::PairSelection selection;
  for (std::size_t i = 0; i < pairs_.items.size(); ++i) {
    if (!is_left_[i]) continue;
    const BatchItem& item = pairs_.items[i];
    for (int k = item.first; k < item.first + item.count; ++k) {
      selection.push_back(pairs_.body_pairs[static_cast<std::size_t>(k)].pair);
    }
  }
  std::ranges::sort(left_, {}, &Interval::t0);
  for (std::size_t i = 0; i < left_.size();) {
    Interval whole = left_[i];
    for (++i; i < left_.size() && left_[i].part == whole.part && left_[i].t0 <= whole.t1; ++i) {
      whole.t1 = std::max(whole.t1, left_[i].t1);
    }
    Certificate& part = part_of(whole);
    if (!part.is_free()) continue;
    const Certificate exact = certify_interval(checker_.exact(), motion_, whole.t0, whole.t1,
                                               selection, *work_.exact_scratch, options_, stop_);
    const long evaluations = part.evaluations + exact.evaluations;
    if (!exact.is_free() || exact.least_clearance < part.least_clearance) part = exact;
    part.evaluations = evaluations;
    if (part.stopped) return stopped();
  }
}

void PartsCertifier::stopped() {
  for (Certificate& part : parts_) {
    if (!part.is_free()) continue;
    part.verdict = Verdict::kUndecided;
    part.stopped = true;
  }
}

std::vector<Certificate> PartsCertifier::run(std::span<const double> times) {
  begin(times);
  while (!intervals_.empty()) {
    next_.clear();
    work_.next_pending.clear();
    const std::span<const Interval> all(intervals_);
    for (std::size_t first = 0; first < all.size(); first += lanes_) {
      if (stop_()) {
        stopped();
        return std::move(parts_);
      }
      examine(all.subspan(first, std::min(lanes_, all.size() - first)));
    }
    std::swap(intervals_, next_);
    items_ = work_.next_pending;  // Not empty, if an interval is open.
  }
  prove_left();
  return std::move(parts_);
}

}  // namespace

std::vector<Certificate> certify_parts(const BatchChecker& checker, const BatchPairs& pairs,
                                       const motion::Motion& motion, std::span<const double> times,
                                       BatchChecker::Scratch& scratch,
                                       const CertificateOptions& options,
                                       const StopCondition& stop) {
  expects(pairs.model == &scratch.model && &scratch.exact == &checker.exact(),
          "pairs and scratch were made by this checker");
  expects(motion.dof() == checker.cell().dof(), "the motion moves all joints of the cell's arms");
  expects(times.size() >= 2 && std::ranges::is_sorted(times), "times ascend, and are two at least");
  expects(options.smallest_deviation > 0, "the smallest deviation is positive");
  expects(options.clearance_ratio >= 0 && options.clearance_ratio <= 1,
          "the clearance ratio is between 0 and 1");
  return PartsCertifier(checker, pairs, motion, scratch, options, stop).run(times);
}

}  // namespace tandem::collision
