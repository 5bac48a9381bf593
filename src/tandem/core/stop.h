#pragma once
/// When to give up: a deadline and a stop token in one.

#include <chrono>
#include <limits>
#include <optional>
#include <stop_token>

#include "tandem/core/result.h"

namespace tandem {

using Clock = std::chrono::steady_clock;

/// Answers "should this work end now?". Copyable; may be asked from any thread.
/// A default-constructed one never stops.
class StopCondition {
 public:
  StopCondition() = default;
  explicit StopCondition(Clock::time_point deadline, std::stop_token token = {})
      : deadline_(deadline), token_(std::move(token)) {}

  /// Stops `seconds` from now [s]; infinity never does.
  static StopCondition after(double seconds, std::stop_token token = {}) {
    StopCondition stop;
    stop.token_ = std::move(token);
    // Beyond a century the clock's own arithmetic would overflow.
    if (seconds < 3e9) {
      stop.deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                          std::chrono::duration<double>(seconds));
    }
    return stop;
  }

  bool cancelled() const { return token_.stop_requested(); }
  bool timed_out() const { return deadline_ && Clock::now() >= *deadline_; }
  bool operator()() const { return cancelled() || timed_out(); }

  /// Time left until the deadline [s], never negative; infinity without a deadline.
  double seconds_left() const {
    if (!deadline_) return std::numeric_limits<double>::infinity();
    const double left = std::chrono::duration<double>(*deadline_ - Clock::now()).count();
    return left > 0 ? left : 0.0;
  }

  /// The same token with the earlier of this deadline and `seconds` from now.
  StopCondition within(double seconds) const {
    StopCondition stop = after(seconds, token_);
    if (deadline_ && (!stop.deadline_ || *deadline_ < *stop.deadline_)) stop.deadline_ = deadline_;
    return stop;
  }

  /// kCancelled or kTimeout, with `what` was interrupted. Ask only after operator() said true.
  Error error(const std::string& what) const {
    if (cancelled()) return {ErrorCode::kCancelled, what + ": stopped on request"};
    return {ErrorCode::kTimeout, what + ": the deadline passed; raise --deadline to allow more"};
  }

 private:
  std::optional<Clock::time_point> deadline_;
  std::stop_token token_;
};

}  // namespace tandem
