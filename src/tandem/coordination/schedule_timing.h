#pragma once
/// Real times for the places of a schedule, so that the arms' limits hold. Internal to
/// coordination/.

#include <limits>
#include <vector>

#include "tandem/motion/cell_motion.h"
#include "tandem/robot/model.h"
#include "tandem/trajectory/limit_check.h"

namespace tandem::coordination {

/// Cubic time maps through places, and how close to the limits they bring each arm. One thread at
/// a time.
///
/// At the ends of its own motion an arm is at rest, and whatever slope c has there, q(c(t)) stays
/// C2: so an arm's spline begins at the last place with local time 0 and ends at the first one at
/// its duration, with free slopes; before and after it waits.
class ScheduleTiming {
 public:
  /// @param arms    each at rest at both ends; must outlive this.
  /// @param limits  of all joints of all arms.
  ScheduleTiming(const std::vector<motion::ArmMotion>& arms,
                 const std::vector<robot::JointLimits>& limits);

  /// Intervals, and how long maps at those become once they are stretched to the limits, about [s].
  struct Guess {
    Eigen::VectorXd intervals;
    double makespan = std::numeric_limits<double>::infinity();
  };
  /// Intervals as short as stretching and shrinking each by itself makes them; by samples.
  /// @param places  two or more, neighbours differ.   @param intervals  one less, > 0 [s].
  Guess guess(const std::vector<Eigen::VectorXd>& places, Eigen::VectorXd intervals);
  /// Maps through the places at such intervals, all stretched alike so that velocity, acceleration
  /// and jerk are within all limits as limit_check sees them, and no slower.
  std::vector<motion::TimeMap> fit(const std::vector<Eigen::VectorXd>& places,
                                   const Eigen::VectorXd& intervals);

  /// Rest to rest along every edge, so that the arms follow the polyline exactly.
  std::vector<motion::TimeMap> stop_and_go(const std::vector<Eigen::VectorXd>& places);

  /// Real times of the places in the last result, first 0 [s].
  const std::vector<double>& times() const { return times_; }

 private:
  void interpolate(const std::vector<Eigen::VectorXd>& places, const Eigen::VectorXd& intervals);
  Eigen::VectorXd local_scales(const std::vector<Eigen::VectorXd>& places) const;
  void finish();

  const std::vector<motion::ArmMotion>& arms_;
  std::vector<robot::JointLimits> limits_;
  Eigen::ArrayXXd slowness_;  ///< By joint: 1 / velocity, acceleration and jerk limit; 0 if none.
  std::vector<motion::ArmMotion> moved_;  ///< Along the maps of the last interpolation.
  std::vector<double> times_;
};

}  // namespace tandem::coordination
