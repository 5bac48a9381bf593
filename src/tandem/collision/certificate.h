#pragma once
/// Continuous-time collision certificate of a motion.

#include <limits>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/stop.h"
#include "tandem/motion/motion.h"

namespace tandem::collision {

enum class Verdict {
  kFree,       ///< Proven: no pair touches at any time.
  kCollision,  ///< A configuration of the motion in which a pair touches.
  kUndecided,  ///< Neither, down to the smallest interval: counts as not free.
};

struct Certificate {
  Verdict verdict = Verdict::kUndecided;
  /// Every pair keeps at least this distance at every time [m]; meaningful if kFree, > 0.
  double least_clearance = std::numeric_limits<double>::infinity();
  double time = 0;       ///< [s] where it failed; if free, near where the least clearance is.
  int pair = -1;         ///< The pair it failed on, or the nearest one.
  double depth = 0;      ///< [m] if kCollision: overlap at `time`, >= 0.
  long evaluations = 0;  ///< Configurations placed.
  bool stopped = false;  ///< The stop condition ended it: kUndecided.

  bool is_free() const { return verdict == Verdict::kFree; }
};

struct CertificateOptions {
  /// Below this largest joint deviation an interval is not divided any more [rad or m].
  double smallest_deviation = 1e-5;
  /// Refine until the certified clearance is within this factor of the true least one; 0: stop as
  /// soon as freedom is proven (the clearance is then a valid but loose bound).
  double clearance_ratio = 0.0;
};

/// Proves or refutes that `motion` keeps all pairs of `selection` apart, by bisection.
/// The middle of an interval is checked before its bound, and intervals are visited coarse to
/// fine, so that collisions are found early.
/// Ref: Schwarzer, Saha, Latombe, Adaptive dynamic collision checking (2005).
Certificate certify(const SsvChecker& checker, const motion::Motion& motion,
                    const world::PairSelection& selection, CollisionChecker::Scratch& scratch,
                    const CertificateOptions& options = {}, const StopCondition& stop = {});

/// The same for t in [t0, t1] only.
Certificate certify_interval(const SsvChecker& checker, const motion::Motion& motion, double t0,
                             double t1, const world::PairSelection& selection,
                             CollisionChecker::Scratch& scratch,
                             const CertificateOptions& options = {},
                             const StopCondition& stop = {});

}  // namespace tandem::collision
