#include "tandem/collision/certificate.h"

#include <algorithm>

#include "tandem/collision/ssv_box.h"

namespace tandem::collision {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One call of certify().
class Certifier {
 public:
  Certifier(const motion::Motion& motion, SsvScratch& scratch, const CertificateOptions& options,
            const StopCondition& stop)
      : motion_(motion),
        scratch_(scratch),
        buffers_(scratch.certificate),
        options_(options),
        stop_(stop) {}

  Certificate run(double t0, double t1, const world::PairSelection& selection);

 private:
  using Finding = PairOnBox::Finding;
  using Interval = CertificateBuffers::Interval;

  bool place(double t);
  bool examine(const Interval& interval);
  bool examine_ends(double t0, double t1);
  Finding examine_pair(int index);
  bool sample(const Interval& interval);
  void note(int pair, double bound);
  bool end(Verdict verdict, int pair);
  bool collision(int pair);

  const motion::Motion& motion_;
  SsvScratch& scratch_;
  CertificateBuffers& buffers_;
  const CertificateOptions& options_;
  const StopCondition& stop_;
  Certificate result_;
  double time_ = 0;       // Of the placement.
  bool is_first_ = true;  // The interval is the whole one.
  double target_ = 0;     // What a pair must keep to be done on an interval.
  double least_sampled_ = kInfinity;
};

/// @return false if the work ends here; result_ then says why.
bool Certifier::place(double t) {
  if (stop_()) {
    result_.stopped = true;
    return end(Verdict::kUndecided, -1);
  }
  time_ = t;
  motion_.position(t, buffers_.q);
  scratch_.place(buffers_.q);
  ++result_.evaluations;
  return true;
}

bool Certifier::end(Verdict verdict, int pair) {
  result_.verdict = verdict;
  result_.time = time_;
  result_.pair = pair;
  return false;
}

bool Certifier::collision(int pair) {
  PairClearance clearance;
  clearance.distance = kInfinity;
  improve(scratch_, pair, clearance);
  result_.depth = std::max(0.0, -clearance.distance);
  return end(Verdict::kCollision, pair);
}

void Certifier::note(int pair, double bound) {
  if (bound >= result_.least_clearance) return;
  result_.least_clearance = bound;
  result_.pair = pair;
  result_.time = time_;
}

Certifier::Finding Certifier::examine_pair(int index) {
  const SsvPair& pair = scratch_.model().pair(index);
  const PairOnBox found = examine_on_box(scratch_, pair, target_, result_.least_clearance);
  // What is outside a closed mesh at one time, and touches it at none, is outside at all times.
  if (is_first_ && pair.solid && is_inside(scratch_, pair)) return Finding::kTouching;
  if (found.finding == Finding::kApart) note(index, found.bound);
  return found.finding;
}

/// The least distance of any sample sets how much clearance is worth proving.
/// @return false if a pair touches.
bool Certifier::sample(const Interval& interval) {
  PairClearance nearest;
  nearest.distance = least_sampled_;
  for (int i = interval.first; i < interval.first + interval.count; ++i) {
    improve(scratch_, buffers_.pairs[static_cast<std::size_t>(i)], nearest);
  }
  least_sampled_ = nearest.distance;
  return least_sampled_ > 0 || collision(nearest.pair);
}

/// Checks the middle and bounds the rest; what stays unproven goes to `next_pairs`.
bool Certifier::examine(const Interval& interval) {
  if (!place(0.5 * (interval.t0 + interval.t1))) return false;
  motion_.deviation(interval.t0, interval.t1, buffers_.D);
  scratch_.set_deviation(buffers_.D);
  const bool smallest = !(buffers_.D.maxCoeff() > options_.smallest_deviation) ||
                        !(interval.t0 < time_ && time_ < interval.t1);
  target_ = 0;
  if (options_.clearance_ratio > 0 && !smallest) {
    if (!sample(interval)) return false;
    target_ = options_.clearance_ratio * least_sampled_;
  }
  const auto first = static_cast<int>(buffers_.next_pairs.size());
  for (int i = interval.first; i < interval.first + interval.count; ++i) {
    const int pair = buffers_.pairs[static_cast<std::size_t>(i)];
    const Finding finding = examine_pair(pair);
    if (finding == Finding::kTouching) return collision(pair);
    if (finding == Finding::kApart) continue;
    if (smallest) return end(Verdict::kUndecided, pair);
    buffers_.next_pairs.push_back(pair);
  }
  const int count = static_cast<int>(buffers_.next_pairs.size()) - first;
  if (count == 0) return true;
  buffers_.next_level.push_back({interval.t0, time_, first, count});
  buffers_.next_level.push_back({time_, interval.t1, first, count});
  return true;
}

/// Whether the still unproven pairs are apart at both ends, which no bisection ever visits.
bool Certifier::examine_ends(double t0, double t1) {
  for (const double t : {t1, t0}) {
    if (!place(t)) return false;
    for (const int index : buffers_.next_pairs) {
      if (!touches(scratch_, scratch_.model().pair(index))) continue;
      return collision(index);
    }
  }
  return true;
}

Certificate Certifier::run(double t0, double t1, const world::PairSelection& selection) {
  time_ = 0.5 * (t0 + t1);
  buffers_.pairs.assign(selection.begin(), selection.end());
  buffers_.level.clear();
  if (!selection.empty()) {
    buffers_.level.push_back({t0, t1, 0, static_cast<int>(selection.size())});
  }
  for (is_first_ = true; !buffers_.level.empty(); is_first_ = false) {
    buffers_.next_level.clear();
    buffers_.next_pairs.clear();
    for (const Interval& interval : buffers_.level) {
      if (!examine(interval)) return result_;
    }
    if (is_first_ && !buffers_.next_level.empty() && !examine_ends(t0, t1)) return result_;
    std::swap(buffers_.level, buffers_.next_level);
    std::swap(buffers_.pairs, buffers_.next_pairs);
  }
  result_.verdict = Verdict::kFree;
  return result_;
}

}  // namespace

Certificate certify(const SsvChecker& checker, const motion::Motion& motion,
                    const world::PairSelection& selection, CollisionChecker::Scratch& scratch,
                    const CertificateOptions& options, const StopCondition& stop) {
  return certify_interval(checker, motion, 0.0, motion.duration(), selection, scratch, options,
                          stop);
}

Certificate certify_interval(const SsvChecker& checker, const motion::Motion& motion, double t0,
                             double t1, const world::PairSelection& selection,
                             CollisionChecker::Scratch& scratch, const CertificateOptions& options,
                             const StopCondition& stop) {
  const SsvModel& model = checker.model();
  expects(motion.dof() == model.dof, "the motion moves all joints of the cell's arms");
  expects(t0 <= t1, "an interval of time ends after it begins");
  expects(options.smallest_deviation > 0, "the smallest deviation is positive");
  expects(options.clearance_ratio >= 0 && options.clearance_ratio <= 1,
          "the clearance ratio is between 0 and 1");
  return Certifier(motion, own_scratch(model, scratch), options, stop).run(t0, t1, selection);
}

}  // namespace tandem::collision
