#include "tandem/coordination/track.h"

#include <algorithm>

#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

Track::Track(const CoordinationProblem& problem, int arm)
    : Track(problem, {arm},
            make_schedule(
                {VectorXd::Zero(1),
                 VectorXd::Constant(1, problem.arms[static_cast<std::size_t>(arm)].duration())})) {}

Track::Track(const CoordinationProblem& problem, std::vector<int> arms, Schedule schedule)
    : problem_(problem), arms_(std::move(arms)), schedule_(std::move(schedule)) {
  expects(!arms_.empty() && schedule_.places.size() > 1, "a track moves");
  for (const int arm : arms_) mask_ |= world::ArmMask{1} << arm;
  expects(schedule_.places.front().size() == static_cast<Index>(arms_.size()),
          "a place has one local time per arm of the track");
}

VectorXd Track::place(double t) const {
  const auto& [places, times] = schedule_;
  if (t <= 0) return places.front();
  if (t >= times.back()) return places.back();
  const auto k = static_cast<std::size_t>(std::ranges::upper_bound(times, t) - times.begin());
  const double u = (t - times[k - 1]) / (times[k] - times[k - 1]);
  return places[k - 1] + u * (places[k] - places[k - 1]);
}

std::vector<double> Track::kinks(double t0, double t1) const {
  const auto& times = schedule_.times;
  const auto first = std::upper_bound(times.begin(), times.end(), t0);
  const auto last = std::lower_bound(first, times.end(), t1);
  return {first, last};
}

void Track::box(double t0, double t1, VectorXd& center, VectorXd& D) const {
  const VectorXd a = place(t0), b = place(t1);
  VectorXd low = a.cwiseMin(b), high = a.cwiseMax(b);
  const auto& times = schedule_.times;
  const auto first = std::upper_bound(times.begin(), times.end(), t0) - times.begin();
  for (auto k = static_cast<std::size_t>(first); k < times.size() && times[k] < t1; ++k) {
    low = low.cwiseMin(schedule_.places[k]);
    high = high.cwiseMax(schedule_.places[k]);
  }
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    const auto arm = static_cast<std::size_t>(arms_[i]);
    const world::Arm& of = problem_.cell().arms()[arm];
    const auto k = static_cast<Index>(i);
    const motion::PiecewiseCubic& motion = problem_.arms[arm];
    motion.position(0.5 * (low[k] + high[k]), center.segment(of.offset, of.dof()));
    motion.deviation(low[k], high[k], D.segment(of.offset, of.dof()));
  }
}

}  // namespace tandem::coordination
