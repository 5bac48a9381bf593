#pragma once
/// The continuous-time certificate by batches.

#include <span>
#include <vector>

#include "tandem/collision/batch_checker.h"
#include "tandem/collision/certificate.h"

namespace tandem::collision {

/// Certificates of the parts of `motion` between consecutive `times`, all at once: intervals are
/// boxes of configurations, proven many at a time, and what these leave open is asked of the exact
/// certificate. Verdicts mean the same as those of `certify_interval`. Clearances are proven up to
/// BatchChecker::kClearanceCap, and `pair` is that of a failure only.
/// @param pairs  compiled by `checker`.
/// @param motion  inside the joint limits.
/// @param times  ascending, inside the motion, at least 2 [s].
/// @return one less than `times`; if `stop` says so, those not done are `stopped`.
/// Ref: docs/methods.md, "Continuous-time certificate".
std::vector<Certificate> certify_parts(const BatchChecker& checker, const BatchPairs& pairs,
                                       const motion::Motion& motion, std::span<const double> times,
                                       BatchChecker::Scratch& scratch,
                                       const CertificateOptions& options = {},
                                       const StopCondition& stop = {});

}  // namespace tandem::collision
